"""The velocity loop: nominal and true plant, and the error between them (§3.2)."""

from __future__ import annotations

import numpy as np

from mptune.arrays import Complex, Real, kernel
from mptune.loops.force_dynamics import force_dynamics


@kernel
def nominal_velocity(s: Complex, mass: float, delay: float) -> Complex:
    """Return G_N,vel(s) = 1/(m_min s) · e^{−(T_S/2 + d_min)s}, force reference to velocity."""
    return np.exp(-s * delay) / (mass * s)  # Eq. 14


@kernel
def true_velocity(
    s: Complex, mass: float, delay: float, tau_a: float, tau_b: float, share_a: float
) -> Complex:
    """Return G_T,vel(s) = 1/(m s) · G_F(s) · e^{−(T_S/2 + d)s}, force reference to velocity."""
    return force_dynamics(s, tau_a, tau_b, share_a) * np.exp(-s * delay) / (mass * s)  # Eq. 15


@kernel
def error_of_factors(force: Complex, lag: Complex, mass_ratio: Real) -> Complex:
    """Return Δ_vel from its factors G_F(s), e^{−s(d − d_min)} and m_min/m."""
    return force * lag * mass_ratio - 1  # Eq. 16


@kernel
def velocity_error(
    s: Complex,
    mass: float,
    delay: float,
    tau_a: float,
    tau_b: float,
    share_a: float,
    nominal_mass: float,
    nominal_delay: float,
) -> Complex:
    """Return Δ_vel(s) = (G_T,vel − G_N,vel)/G_N,vel, the integrators cancelled by hand."""
    force = force_dynamics(s, tau_a, tau_b, share_a)
    return error_of_factors(force, np.exp(-s * (delay - nominal_delay)), nominal_mass / mass)


@kernel
def velocity_controller(k_p_vel: float) -> float:
    """Return G_V(s) = K_P,vel."""
    return k_p_vel  # Eq. 18
