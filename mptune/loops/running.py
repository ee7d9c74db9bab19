"""A family's loops as they run, with all that the gains leave alone computed once.

The sampled loop is L = K_P,vel (V + C X): X and V, filtered position and Eq. 23's velocity over
F_ref, are the plant's and the filters', and only C, Eq. 22 under Tustin, knows the gains. A search
that asks the same plants again and again keeps X and V at its frequencies.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import ComplexArray, FloatArray, kernel
from mptune.loops.sampled import (
    SampledPlant,
    characteristic,
    coefficient_count,
    measured_parts,
    sampled_plant,
)
from mptune.loops.velocity import plant_at
from mptune.params.packed import Plant

if TYPE_CHECKING:
    from mptune.params.packed import LoopGains, MeasurementPath, Plants

_POINTS = 220  # frequencies on a logarithmic scale
_IMMOVABLE = 1e300  # kg: a plant of which nothing is heard but the force
_LINEAR = 60  # and on a linear one: the highest peaks lie near half the sampling rate


class RunningFamily(NamedTuple):
    """A family's plants as the controller samples them, and their responses at fixed frequencies.

    See ``mptune.loops.sampled.SampledPlant`` for a single one.
    """

    omega: FloatArray  # (F,) rad/s, rising, the last one half the sampling rate
    mass: FloatArray  # (N,) kg
    position: FloatArray  # (N, M) numerators of X in w
    velocity: FloatArray  # (N, M) of V
    factor_a: FloatArray  # (N,)
    factor_b: FloatArray  # (N,)
    path: FloatArray  # (D,) denominator that the measurement path adds
    position_at: ComplexArray  # (N, F) X
    velocity_at: ComplexArray  # (N, F) V
    by_force: FloatArray  # (2, N, M) what of X and V is heard of the force, not of the place
    force_at: ComplexArray  # (2, N, F) the same at the frequencies; zero without an estimator
    period: float  # s, T_S


@kernel
def force_part(family: RunningFamily, n: int) -> SampledPlant:
    """Return what one plant's controller hears of the force alone."""
    return SampledPlant(
        family.by_force[0, n],
        family.by_force[1, n],
        family.factor_a[n],
        family.factor_b[n],
        family.path,
    )


@kernel
def sampled_at(family: RunningFamily, n: int) -> SampledPlant:
    """Return one plant of a family."""
    return SampledPlant(
        family.position[n],
        family.velocity[n],
        family.factor_a[n],
        family.factor_b[n],
        family.path,
    )


def running_family(
    low: float, plants: Plants, path: MeasurementPath, period: float
) -> RunningFamily:
    """Return a family as it runs, its responses known from ``low`` [rad/s] on.

    Delays are at least T_S/2. Between the frequencies peaks and crossings are to be refined.
    """
    half_rate = np.pi / period
    rising = np.geomspace(min(low, 0.5 * half_rate), half_rate, _POINTS)
    omega = np.union1d(rising, np.linspace(0.02, 1, _LINEAR) * half_rate)
    count = coefficient_count(plants.delay.max(), path, period)
    return RunningFamily(omega, plants.mass, *_sampled(omega, plants, path, period, count), period)


@kernel
def _sampled(
    omega: FloatArray, plants: Plants, path: MeasurementPath, period: float, count: int
) -> tuple[
    FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, ComplexArray, ComplexArray,
    FloatArray, ComplexArray,
]:  # fmt: skip
    number = len(plants.mass)
    position, velocity = np.empty((number, count)), np.empty((number, count))
    factor_a, factor_b, added = np.empty(number), np.empty(number), np.ones(1)
    position_at = np.empty((number, len(omega)), np.complex128)
    velocity_at = np.empty((number, len(omega)), np.complex128)
    by_force = np.zeros((2, number, count))
    force_at = np.zeros((2, number, len(omega)), np.complex128)
    for n in range(number):
        one = sampled_plant(plant_at(plants, n), path, period, count)
        position[n], velocity[n] = one.position, one.velocity
        factor_a[n], factor_b[n], added = one.factor_a, one.factor_b, one.path
        for f in range(len(omega)):
            x, v = measured_parts(1j * omega[f], one, period)
            position_at[n, f], velocity_at[n, f] = x, v
        if path.estimator_mass > 0:
            plant = plant_at(plants, n)
            still = Plant(_IMMOVABLE, plant.delay, plant.tau_a, plant.tau_b, plant.share_a)
            one = sampled_plant(still, path, period, count)
            by_force[0, n], by_force[1, n] = one.position, one.velocity
            for f in range(len(omega)):
                x, v = measured_parts(1j * omega[f], one, period)
                force_at[0, n, f], force_at[1, n, f] = x, v
    return (
        position, velocity, factor_a, factor_b, added, position_at, velocity_at, by_force, force_at,
    )  # fmt: skip


@kernel
def inside_unit_circle(polynomial: FloatArray) -> bool:
    """Return whether all roots of a polynomial, highest power first, lie inside the unit circle.

    Schur and Cohn: a polynomial is replaced by one of a degree less as long as its last
    coefficient is smaller than its first. Rounding can mistake roots within about 1e-6 of the
    circle for either side: a search may, a verdict may not.
    """
    left = polynomial / polynomial[0]
    for degree in range(len(left) - 1, 0, -1):
        last = left[degree]
        rest = 1 - last * last
        if not rest > 0:
            return False
        for i in range((degree + 1) // 2):
            j = degree - i
            first, other = left[i], left[j]
            left[i], left[j] = (first - last * other) / rest, (other - last * first) / rest
        if degree % 2 == 0:
            left[degree // 2] *= (1 - last) / rest
    return True


@kernel
def runs_stable(family: RunningFamily, n: int, gains: LoopGains) -> bool:
    """Return whether one plant's loop is stable as it runs, as far as rounding can tell."""
    return inside_unit_circle(characteristic(sampled_at(family, n), gains, family.period))
