"""The loop as it runs: decided and held at T_S, filtered at T_S,fast, with a fixed delay.

Seen where it is broken at F_ref, that loop is exactly a discrete one at T_S, since everything else
runs at a whole fraction of T_S: the force reference is held, arrives at the plant of Eq. 15 after
valve and computation at any instant, and the position is sampled at the fast ticks, where median
(one sample), filter and Eq. 23 turn it into what the controller reads. With w = e^{−sT_S} and the
position between samples from the modified z-transform ::

    x(w, θ) = Σ_sides share/m · [ D_θ(w) − τ I_θ(w) + τ² y_θ(w) ]
    I_θ = T [w/(1 − w) + θ]                                      of an integrator
    D_θ = T² [w (1 + w)/(2 (1 − w)²) + θ w/(1 − w) + θ²/2]       of two
    y_θ = E^θ (1 − E) w/(1 − E w) + 1 − E^θ,   E = e^{−T/τ}      of a lag

a weighted sum over the last ticks is a numerator in w, with real coefficients, over
(1 − w)² (1 − E_A w)(1 − E_B w)(1 − aⁿ w), a being the filter's pole and n the ticks in T_S. A state
estimator reads the force as well, F(w, θ) = Σ_sides share·y_θ; with M what its error becomes in a
tick, its states are Σ_i Mⁱ (…) over the ticks of one period, times adj(I − Mⁿ w), over
det(I − Mⁿ w) in the place of 1 − aⁿ w. Nothing is approximated but the median, which a linear loop
can only have as one sample.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numba
import numpy as np

from mptune.arrays import BoolArray, Complex, ComplexArray, FloatArray, kernel, parallel_kernel
from mptune.loops.held_force import adjugate, force_terms
from mptune.loops.velocity import plant_at
from mptune.signals.differentiator import TAPS
from mptune.signals.tustin import discrete_response, discretise

if TYPE_CHECKING:
    from mptune.loops.family import FamilyLoops
    from mptune.params.packed import LoopGains, MeasurementPath, Plant, Plants

_UNIT_CIRCLE = 1e-9  # a multiplier nearer to the circle than this is undecided
_COMPANIONS = 8_000_000  # numbers of companion matrices held at a time, 64 MB
_QUARTIC = 4  # degree of the plant's denominator in w
_EXTRA = 5  # older samples that Eq. 23 reaches back to
_ADJUGATE = 2  # degree in w of adj(I − Mⁿ w)


class SampledPlant(NamedTuple):
    """One plant as the controller samples it: response = numerator/denominator in w."""

    position: FloatArray  # (M,) numerator of filtered position over F_ref
    velocity: FloatArray  # (M,) numerator of Eq. 23's velocity over F_ref
    factor_a: float  # E_A
    factor_b: float  # E_B
    path: FloatArray  # (D,) denominator that the measurement path adds, 1 first


@kernel
def coefficient_count(longest_delay: float, path: MeasurementPath, period: float) -> int:
    """Return M, enough coefficients for plants up to that total delay [s]."""
    oldest = (round(period / path.sample_time) + _EXTRA) * path.sample_time
    more = _ADJUGATE if path.estimator_mass > 0 else 0
    return _QUARTIC + 1 + more + int(np.ceil((oldest + (longest_delay - period / 2)) / period))


@kernel
def sampled_plant(plant: Plant, path: MeasurementPath, period: float, count: int) -> SampledPlant:
    """Return one plant with its measurement path as the controller samples it.

    Parameters
    ----------
    plant
        The plant of Eq. 15; its delay is at least T_S/2, which the sampling itself stands for.
    path
        Median, filter and Eq. 23; its sample time divides ``period``.
    period
        T_S [s].
    count
        Number of coefficients, see ``coefficient_count``.
    """
    ticks = round(period / path.sample_time)
    factor_a = np.exp(-period / plant.tau_a) if plant.tau_a > 0 else 0.0
    factor_b = np.exp(-period / plant.tau_b) if plant.tau_b > 0 else 0.0
    delay = plant.delay - period / 2  # valve and computation
    if path.estimator_mass > 0:
        return _estimated_plant(plant, path, period, count, factor_a, factor_b)
    position, velocity = np.zeros(count), np.zeros(count)
    terms = np.zeros(_QUARTIC + 1)
    for back in range(1, ticks + _EXTRA + 1):  # ticks before the controller reads
        age = (back * path.sample_time + delay) / period
        whole = int(np.ceil(age - 1e-12))
        within = max(whole - age, 0.0)
        _position_terms(terms, within, plant, factor_a, factor_b, period)
        of_position = _filter_weight(back - 1, ticks, path.filter_pole)
        of_velocity = 0.0
        for tap in range(len(TAPS)):
            weight = _filter_weight(back - 1 - tap, ticks, path.filter_pole)
            of_velocity += TAPS[tap] * weight / path.sample_time  # Eq. 23
        for power in range(_QUARTIC + 1):
            position[whole + power] += of_position * terms[power]
            velocity[whole + power] += of_velocity * terms[power]
    faded = np.array([1.0, -(path.filter_pole**ticks)])
    return SampledPlant(position, velocity, factor_a, factor_b, faded)


@kernel
def _estimated_plant(  # noqa: C901 - one sum over the ticks of a period
    plant: Plant,
    path: MeasurementPath,
    period: float,
    count: int,
    factor_a: float,
    factor_b: float,
) -> SampledPlant:
    """Return one plant with its state estimator as the controller samples it."""
    fast, mass = path.sample_time, path.estimator_mass
    ticks = round(period / fast)
    delay = plant.delay - 0.5 * period  # valve and computation
    gain = np.array([path.l_1, path.l_2, -path.l_3])
    ahead = np.array([[1.0, fast, -fast * fast / 2], [0.0, 1.0, -fast], [0.0, 0.0, 1.0]])
    pushed = np.array([fast * fast / 2, fast, 0.0]) / mass
    step = ahead - np.outer(gain, ahead[0])  # M = (I − L C) A
    pushed = pushed - gain * pushed[0]
    summed, power = np.zeros((count, 3)), np.eye(3)
    terms = np.zeros(_QUARTIC + 1)
    for back in range(1, ticks + 1):  # ticks before the controller reads; the median is one
        age = (back * fast + delay) / period
        whole = int(np.ceil(age - 1e-12))
        within = max(whole - age, 0.0)
        _position_terms(terms, within, plant, factor_a, factor_b, period)
        of_place, of_force = power @ gain, power @ pushed
        for degree in range(_QUARTIC + 1):
            for i in range(3):
                summed[whole + degree, i] += of_place[i] * terms[degree]
        force_terms(terms, within, plant, factor_a, factor_b)
        for degree in range(_QUARTIC + 1):
            for i in range(3):
                summed[whole + degree, i] += of_force[i] * terms[degree]
        power = step @ power
    trace = power[0, 0] + power[1, 1] + power[2, 2]
    adjoint = adjugate(power)
    cofactors = adjoint[0, 0] + adjoint[1, 1] + adjoint[2, 2]
    faded = np.array([1.0, -trace, cofactors, -np.linalg.det(power)])
    heard = np.zeros((2, count))
    once = power - trace * np.eye(3)  # adj(I − Mⁿ w) = I + w once + w² adj(Mⁿ)
    for k in range(count):
        for row in range(2):
            heard[row, k] += summed[k, row]
            for i in range(3):
                if k + 1 < count:
                    heard[row, k + 1] += once[row, i] * summed[k, i]
                if k + 2 < count:
                    heard[row, k + 2] += adjoint[row, i] * summed[k, i]
    return SampledPlant(heard[0].copy(), heard[1].copy(), factor_a, factor_b, faded)


@kernel
def _filter_weight(age: int, ticks: int, pole: float) -> float:
    """Return the filter's weight of a sample within one period; older ones repeat it by aⁿ w."""
    return (1 - pole) * pole**age if 0 <= age < ticks else 0.0


@kernel
def _position_terms(
    terms: FloatArray,
    within: float,
    plant: Plant,
    factor_a: float,
    factor_b: float,
    period: float,
) -> None:
    """Fill the coefficients of x(w, θ) times (1 − w)² (1 − E_A w)(1 − E_B w)."""
    tau_a, tau_b, share_a = plant.tau_a, plant.tau_b, plant.share_a
    share_b = 1 - share_a
    faded_a = factor_a**within
    faded_b = factor_b**within
    mean = share_a * tau_a + share_b * tau_b
    twice = period * period
    slow = twice / 2  # of w (1 + w)/(1 − w)²
    ramp = twice * within - mean * period  # of w/(1 − w)
    level = twice * within * within / 2 - mean * period * within  # of 1
    level += share_a * tau_a * tau_a * (1 - faded_a) + share_b * tau_b * tau_b * (1 - faded_b)
    lag_a = share_a * tau_a * tau_a * (1 - factor_a) * faded_a  # of w/(1 − E_A w)
    lag_b = share_b * tau_b * tau_b * (1 - factor_b) * faded_b
    once, both = factor_a + factor_b, factor_a * factor_b  # (1 − E_A w)(1 − E_B w)
    terms[0] = level
    terms[1] = slow + ramp + lag_a + lag_b - level * (2 + once)
    terms[2] = slow * (1 - once) - ramp * (1 + once) + level * (1 + 2 * once + both)
    terms[2] -= lag_a * (2 + factor_b) + lag_b * (2 + factor_a)
    terms[3] = slow * (both - once) + ramp * (once + both) - level * (once + 2 * both)
    terms[3] += lag_a * (1 + 2 * factor_b) + lag_b * (1 + 2 * factor_a)
    terms[4] = (slow - ramp + level) * both - lag_a * factor_b - lag_b * factor_a
    for power in range(_QUARTIC + 1):
        terms[power] /= plant.mass


@kernel
def _polynomial(coefficients: FloatArray, w: Complex) -> Complex:
    value = 0 * w
    for i in range(len(coefficients) - 1, -1, -1):
        value = value * w + coefficients[i]
    return value


@kernel
def measured_parts(s: Complex, plant: SampledPlant, period: float) -> tuple[Complex, Complex]:
    """Return measured position and measured velocity over F_ref, at s or at z = e^{sT_S}."""
    w = np.exp(-s * period)
    poles = (1 - w) ** 2 * (1 - plant.factor_a * w) * (1 - plant.factor_b * w)
    poles *= _polynomial(plant.path, w)
    return _polynomial(plant.position, w) / poles, _polynomial(plant.velocity, w) / poles


@kernel
def sampled_controller(s: Complex, gains: LoopGains, period: float) -> Complex:
    """Return Eq. 22 under Tustin at T_S, position error to velocity reference [1/s]."""
    return discrete_response(discretise(gains, period), np.exp(-s * period))


@kernel
def sampled_loop(s: Complex, plant: SampledPlant, gains: LoopGains, period: float) -> Complex:
    """Return the loop gain broken at F_ref, as it runs."""
    position, velocity = measured_parts(s, plant, period)
    return gains.k_p_vel * (velocity + sampled_controller(s, gains, period) * position)


@kernel
def _times(polynomial: FloatArray, zeroth: float, first: float, second: float) -> FloatArray:
    """Return a polynomial in w times a quadratic one."""
    product = np.zeros(len(polynomial) + 2)
    for i in range(len(polynomial)):
        product[i] += zeroth * polynomial[i]
        product[i + 1] += first * polynomial[i]
        product[i + 2] += second * polynomial[i]
    return product


@kernel
def characteristic(plant: SampledPlant, gains: LoopGains, period: float) -> FloatArray:
    """Return the closed loop's characteristic polynomial, leading coefficient 1 first.

    Read as coefficients of falling powers of z, its roots are those characteristic multipliers
    over T_S that are not zero; read as rising powers of w, their inverses. Where the position
    controller has no integral term, or no gain at all, the integrators that it leaves outside the
    loop are taken out.
    """
    law = discretise(gains, period)
    factor_a, factor_b = plant.factor_a, plant.factor_b
    opened = np.zeros(len(plant.position) - 4)
    opened[: len(plant.path)] = plant.path
    opened = _times(opened, 1.0, -2.0, 1.0)
    opened = _times(opened, 1.0, -factor_a - factor_b, factor_a * factor_b)
    opened = _times(_times(opened, 1.0, law.a1, law.a2), 1.0, -1.0, 0.0)
    velocity = _times(_times(plant.velocity, 1.0, law.a1, law.a2), 1.0, -1.0, 0.0)
    shaped = _times(_times(plant.position, law.b0, law.b1, law.b2), 1.0, -1.0, 0.0)
    summed = _times(_times(plant.position, 1.0, law.a1, law.a2), law.integral, law.integral, 0.0)
    closed = opened + gains.k_p_vel * (velocity + shaped + summed)  # of (1 + L_F) = 0
    for _ in range(_outside(gains)):
        closed = np.cumsum(closed)[:-1]  # over 1 − w
    return closed


@kernel
def _outside(gains: LoopGains) -> int:
    """Return how many integrators the loop does not hold: the I-term's, the position's."""
    if gains.k_i_pos > 0:
        return 0
    return 1 if gains.k_p_pos > 0 else 2


@parallel_kernel
def _characteristics(
    plants: Plants, gains: LoopGains, path: MeasurementPath, period: float
) -> FloatArray:
    count = coefficient_count(plants.delay.max(), path, period)
    found = np.empty((len(plants.mass), count + 4 - _outside(gains)))
    for n in numba.prange(len(plants.mass)):
        plant = sampled_plant(plant_at(plants, n), path, period, count)
        found[n] = characteristic(plant, gains, period)
    return found


def multipliers(loops: FamilyLoops, period: float) -> ComplexArray:
    """Return the closed loops' characteristic multipliers over T_S, ``(N, M)``.

    Those that are always zero (a finite memory's) are left out.

    Parameters
    ----------
    loops
        The family, whose delays hold half a sampling period for the hold and must be at least that,
        the gains, and the measurement path at T_S,fast.
    period
        T_S [s].
    """
    polynomials = _characteristics(loops.plants, loops.gains, loops.path, period)
    count, order = polynomials.shape[0], polynomials.shape[1] - 1
    at_once = max(_COMPANIONS // order**2, 1)
    found = np.empty((count, order), np.complex128)
    for first in range(0, count, at_once):
        some = polynomials[first : first + at_once]
        companion = np.zeros((len(some), order, order))
        companion[:, 0, :] = -some[:, 1:]
        companion[:, np.arange(1, order), np.arange(order - 1)] = 1.0
        found[first : first + at_once] = np.linalg.eigvals(companion)
    return found


def stable_as_sampled(loops: FamilyLoops, period: float) -> tuple[BoolArray, BoolArray]:
    """Return ``(N,)`` whether all multipliers lie inside the unit circle, and whether that is sure.

    Parameters as of ``multipliers``.
    """
    radius = np.abs(multipliers(loops, period)).max(axis=1)
    sure = np.abs(radius - 1) > _UNIT_CIRCLE
    return np.asarray(sure & (radius < 1)), np.asarray(sure)
