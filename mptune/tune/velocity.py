"""The velocity gain: the largest that keeps Eq. 17's requirement, in closed form."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mptune.loops.broken import velocity_path
from mptune.loops.velocity import nominal_velocity
from mptune.robust.grid import first_grid, frequency_range
from mptune.robust.sweep import CONVERGED
from mptune.robust.verdict import allowed_ratio

if TYPE_CHECKING:
    from mptune.arrays import ComplexArray, FloatArray
    from mptune.params.packed import MeasurementPath, NominalPlant
    from mptune.robust.model import LinearModel

_ROUNDS = 6  # of refinement about the limiting frequency, a factor of four each


@dataclass(frozen=True)
class VelocityGain:
    """The largest gain, and what limits it.

    Attributes
    ----------
    k_p_vel
        K_P,vel [N s/m]; 0 where no gain meets the requirement.
    limited_by
        ``"velocity_ratio"``, ``"bounds"`` or ``"nominal stability"``.
    frequency
        The limiting frequency [rad/s]; 0 for the limit of vanishing frequency.
    plant
        Index of the limiting plant.
    """

    k_p_vel: float
    limited_by: str
    frequency: float
    plant: int


def largest_velocity_gain(
    model: LinearModel, upper: float = np.inf, hand: float = 0.0
) -> VelocityGain:
    """Return the largest K_P,vel up to which every gain meets Eq. 17's requirement.

    With z = 1/K_P,vel and g the inverse of the nominal plant, the requirement at one frequency,
    |1 + g z| ≥ max|Δ_vel|/allowed, is a quadratic inequality in z; its larger root is the smallest
    admissible z. What the sweep's convergence leaves open, 1e-4 of the ratio, is kept in hand.

    Parameters
    ----------
    model
        The study's linear model; the range of frequencies is chosen from its own gains.
    hand
        Logarithm kept in hand of the limit beside that.
    upper
        Upper bound of the gain [N s/m]. About half the gain at which the nominal loop turns
        unstable bounds it too, so that a family without uncertainty has an answer.
    """
    nominal, path, limit = model.nominal, model.path, model.requirements.velocity_ratio
    if model.estimated:
        return _around_an_estimator(model, upper)
    omega = first_grid(*frequency_range(model.plants, nominal, model.gains))
    at_rest = np.abs(nominal.mass / model.plants.mass - 1)  # |Δ_vel| as ω → 0, whatever the gain
    if at_rest.max() >= allowed_ratio(limit, omega[:1])[0]:
        return VelocityGain(0.0, "velocity_ratio", 0.0, int(np.argmax(at_rest)))
    smallest, frequency, plant = 0.0, 0.0, 0
    for _ in range(_ROUNDS):
        found = model.sides(omega, model.gains)
        need = found.left[0] / (allowed_ratio(limit, omega) * (1 - CONVERGED) * np.exp(-hand))
        root = _larger_root(_inverse_plant(omega, nominal, path), need)
        worst = int(np.argmax(root))
        smallest, frequency = float(root[worst]), float(omega[worst])
        plant = int(found.plant[0, worst])
        beside = omega[[max(worst - 1, 0), min(worst + 1, len(omega) - 1)]]
        omega = np.union1d(omega, np.linspace(beside[0], beside[1], 9))
    lag = nominal.delay + path.filter_time + 3.5 * path.sample_time
    candidates = (
        (1 / smallest if smallest > 0 else np.inf, "velocity_ratio"),
        (upper, "bounds"),
        (np.pi / 4 * nominal.mass / lag, "nominal stability"),
    )
    gain, limited_by = min(candidates)
    return VelocityGain(gain, limited_by, frequency, plant)


def _around_an_estimator(model: LinearModel, upper: float) -> VelocityGain:
    """Return the largest gain where Eq. 17 asks nothing: what the nominal dead time allows.

    At high frequency the loop at F_ref is K_P,vel e^{−sd}/(m̂s), whatever the mass; with the lags
    of pressure and sampling less than this bound is stable.
    """
    nominal = model.nominal_along(model.filters)
    most = np.pi / 2 * model.filters.estimator_mass / nominal.delay
    gain, limited_by = min((upper, "bounds"), (most, "nominal stability"))
    return VelocityGain(gain, limited_by, 0.0, 0)


def _inverse_plant(omega: FloatArray, nominal: NominalPlant, path: MeasurementPath) -> ComplexArray:
    """Return 1/(G_N,vel H) at jω, ``(F,)``: the velocity loop gain is K_P,vel over this."""
    gain = [nominal_velocity(s, nominal) * velocity_path(s, path) for s in 1j * omega]
    return 1 / np.array(gain, np.complex128)


def _larger_root(inverse_plant: ComplexArray, need: FloatArray) -> FloatArray:
    """Return the larger root z of |1 + g z|² = need²; 0 where every z ≥ 0 will do."""
    half = np.asarray(inverse_plant.real, np.float64)
    square = np.abs(inverse_plant) ** 2
    discriminant = half**2 + square * (need**2 - 1)
    root = (np.sqrt(np.maximum(discriminant, 0)) - half) / square
    return np.where((discriminant > 0) & (root > 0), root, 0.0)
