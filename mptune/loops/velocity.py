"""The velocity loop: nominal and true plant, and the error between them (§3.2)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import Complex, Real, kernel
from mptune.loops.force_dynamics import force_dynamics
from mptune.params.packed import Plant

if TYPE_CHECKING:
    from mptune.params.packed import NominalPlant, Plants


@kernel
def plant_at(plants: Plants, n: int) -> Plant:
    """Return one plant of a family."""
    return Plant(
        plants.mass[n], plants.delay[n], plants.tau_a[n], plants.tau_b[n], plants.share_a[n]
    )


@kernel
def nominal_velocity(s: Complex, nominal: NominalPlant) -> Complex:
    """Return G_N,vel(s) = 1/(m_min s) · e^{−(T_S/2 + d_min)s}, force reference to velocity."""
    return np.exp(-s * nominal.delay) / (nominal.mass * s)  # Eq. 14


@kernel
def true_velocity(s: Complex, plant: Plant) -> Complex:
    """Return G_T,vel(s) = 1/(m s) · G_F(s) · e^{−(T_S/2 + d)s}, force reference to velocity."""
    force = force_dynamics(s, plant.tau_a, plant.tau_b, plant.share_a)
    return force * np.exp(-s * plant.delay) / (plant.mass * s)  # Eq. 15


@kernel
def error_of_factors(force: Complex, lag: Complex, mass_ratio: Real) -> Complex:
    """Return Δ_vel from its factors G_F(s), e^{−s(d − d_min)} and m_min/m."""
    return force * lag * mass_ratio - 1  # Eq. 16


@kernel
def velocity_error(s: Complex, plant: Plant, nominal: NominalPlant) -> Complex:
    """Return Δ_vel(s) = (G_T,vel − G_N,vel)/G_N,vel, the integrators cancelled by hand."""
    force = force_dynamics(s, plant.tau_a, plant.tau_b, plant.share_a)
    lag = np.exp(-s * (plant.delay - nominal.delay))
    return error_of_factors(force, lag, nominal.mass / plant.mass)


@kernel
def velocity_controller(k_p_vel: float) -> float:
    """Return G_V(s) = K_P,vel."""
    return k_p_vel  # Eq. 18
