"""The certificate's function over a box of frequencies and plants, and its gradient.

F = |n|² − γ²|d|² = α|Y|² + 2 Re(βY) + δ, negative wherever the figure is below γ: no division, and
a denominator that does not vanish is implied. The coordinates of a box are, in this order, ω
[rad/s], μ = m_N/m, the delay d [s], τ_A and τ_B [s], an extra phase φ [rad] and the logarithm γ of
an extra gain, both zero but where a phase or a gain margin is asked for. With Ŷ = μH + E,
H = Σ_k z_k G_F(jω_k) e^{−j(ω_k − ω)d}, Eq. 11 as G_F = a/(1 + jωτ_A) + (1 − a)/(1 + jωτ_B) and
a = A_A/(A_A + A_B), and E such a sum of its own where a state estimator hears the force, whose mass
it does not know, Y = Ŷ e^{−j(ωd + φ)}: |Y|
knows nothing of the main phase, which therefore stands with β alone. The gain multiplies Ŷ, whose
derivative by γ is itself. A compliance's numerator is
μn_0: its δ holds μ²|n_0|².
"""

from __future__ import annotations

import math
from typing import NamedTuple

from mptune.arrays import FloatArray, Real, kernel
from mptune.certify.balls import ROUND, Dual, modulus, widened
from mptune.certify.discs import (
    Disc,
    disc_of,
    lag,
    lagging,
    multiple,
    product,
    slope_of,
    total,
    turning_disc,
    twice_real,
)
from mptune.certify.rows import (
    ALPHA_D,
    ALPHA_N,
    BETA_D,
    BETA_N,
    DELTA_D,
    DELTA_N,
    FIXED,
    holds_force,
    stored,
)

OMEGA, RATIO, DELAY, TAU_A, TAU_B, PHASE, GAIN = 0, 1, 2, 3, 4, 5, 6
SIDES = 7


class Enclosed(NamedTuple):
    """F at the centre, its rounding, and how far it may move over the box by the discs alone."""

    value: float
    error: float
    spread: float


@kernel
def _weighed(row: FloatArray, top: int, bottom: int, num: float, den: float) -> Dual:
    """Return num times one coefficient of a row less den times another."""
    a, b = stored(row, top), stored(row, bottom)
    rounding = 2 * ROUND * (num * modulus(a.value) + den * modulus(b.value))
    rounding_slope = 2 * ROUND * (num * modulus(a.slope) + den * modulus(b.slope))
    return Dual(
        num * a.value - den * b.value,
        widened(num * a.error + den * b.error + rounding),
        widened(num * a.spread + den * b.spread + rounding),
        num * a.slope - den * b.slope,
        widened(num * a.slope_spread + den * b.slope_spread + rounding_slope),
    )


class PlantDiscs(NamedTuple):
    """Ŷ, and its derivatives by ω, d, τ_A and τ_B, and by μ."""

    whole: Disc
    by_omega: Disc
    by_delay: Disc
    by_tau_a: Disc
    by_tau_b: Disc
    by_ratio: Disc


@kernel
def _term(
    coefficient: Dual,
    shift: float,
    share_a: float,
    centre: FloatArray,
    half: FloatArray,
) -> PlantDiscs:
    """Return one term z_k G_F(jω_k) e^{−j(ω_k − ω)d} of H or E with its derivatives."""
    omega, half_omega = centre[OMEGA] + shift, half[OMEGA]
    value, slope = disc_of(coefficient), slope_of(coefficient)
    if shift != 0:
        turn = turning_disc(shift * centre[DELAY], abs(shift) * half[DELAY] * (1 + 4 * ROUND))
        value, slope = product(value, turn), product(slope, turn)
    lag_a = lag(omega, centre[TAU_A], half_omega, half[TAU_A])
    lag_b = lag(omega, centre[TAU_B], half_omega, half[TAU_B])
    force = total(multiple(lag_a, share_a, 0.0), multiple(lag_b, 1 - share_a, 0.0))  # Eq. 11
    square_a = multiple(product(value, product(lag_a, lag_a)), share_a, 0.0)
    square_b = multiple(product(value, product(lag_b, lag_b)), 1 - share_a, 0.0)
    whole = product(value, force)
    moving = total(
        multiple(square_a, centre[TAU_A], half[TAU_A]),
        multiple(square_b, centre[TAU_B], half[TAU_B]),
    )
    return PlantDiscs(
        whole,
        total(product(slope, force), lagging(moving)),
        lagging(multiple(whole, shift, 0.0)),
        lagging(multiple(square_a, omega, half_omega)),
        lagging(multiple(square_b, omega, half_omega)),
        whole,
    )


@kernel
def plant_over(
    row: FloatArray, shifts: FloatArray, share_a: float, centre: FloatArray, half: FloatArray
) -> PlantDiscs:
    """Return Ŷ and its derivatives over a box ``centre``, ``half``, ``(SIDES,)`` each."""
    terms, ratio, reach = len(shifts), centre[RATIO], half[RATIO]
    found = _term(stored(row, terms - 1), shifts[-1], share_a, centre, half)
    for k in range(terms - 1):
        found = _sum(found, _term(stored(row, k), shifts[k], share_a, centre, half))
    scaled = PlantDiscs(
        multiple(found.whole, ratio, reach),
        multiple(found.by_omega, ratio, reach),
        multiple(found.by_delay, ratio, reach),
        multiple(found.by_tau_a, ratio, reach),
        multiple(found.by_tau_b, ratio, reach),
        found.whole,
    )
    if holds_force(row, terms):
        for k in range(terms):
            one = _term(stored(row, terms + FIXED + k), shifts[k], share_a, centre, half)
            scaled = _sum(scaled, _without_mass(one))
    return scaled


@kernel
def force_over(
    row: FloatArray, shifts: FloatArray, share_a: float, centre: FloatArray, half: FloatArray
) -> PlantDiscs:
    """Return the sum of a row's terms that know nothing of the mass, as ``plant_over`` does."""
    terms = len(shifts)
    found = _without_mass(_term(stored(row, terms - 1), shifts[-1], share_a, centre, half))
    for k in range(terms - 1):
        one = _term(stored(row, k), shifts[k], share_a, centre, half)
        found = _sum(found, _without_mass(one))
    return found


@kernel
def _amplified(one: PlantDiscs, level: float, half: float) -> PlantDiscs:
    """Return Ŷ and its derivatives times e^γ, for γ within ``half`` of a level."""
    if level == 0 and half == 0:
        return one
    gain = math.exp(level)
    reach = gain * (math.expm1(half) * (1 + 4 * ROUND) + 4 * ROUND)
    return PlantDiscs(
        multiple(one.whole, gain, reach),
        multiple(one.by_omega, gain, reach),
        multiple(one.by_delay, gain, reach),
        multiple(one.by_tau_a, gain, reach),
        multiple(one.by_tau_b, gain, reach),
        multiple(one.by_ratio, gain, reach),
    )


@kernel
def _without_mass(one: PlantDiscs) -> PlantDiscs:
    nothing = Disc(complex(0.0, 0.0), 0.0, 0.0)
    return PlantDiscs(one.whole, one.by_omega, one.by_delay, one.by_tau_a, one.by_tau_b, nothing)


@kernel
def _sum(a: PlantDiscs, b: PlantDiscs) -> PlantDiscs:
    return PlantDiscs(
        total(a.whole, b.whole),
        total(a.by_omega, b.by_omega),
        total(a.by_delay, b.by_delay),
        total(a.by_tau_a, b.by_tau_a),
        total(a.by_tau_b, b.by_tau_b),
        total(a.by_ratio, b.by_ratio),
    )


@kernel
def _swing_of_slope(top: Dual, num: float, ratio: float, half: float) -> Real:
    """Return how far num·2μ|n_0|² may be from its value at the centre."""
    size, wide = num * top.value.real, num * (top.spread + top.error)
    return 2 * half * (size + wide) + 2 * ratio * wide + 8 * ROUND * ratio * size


@kernel
def _swung(delta: Dual, top: Dual, num: float, ratio: float, half: float) -> Dual:
    """Return δ, which holds num·μ²|n_0|² at the centre's μ, with what a box's other μ add to it."""
    size, swing = num * top.value.real, (2 * ratio + half) * half
    wide, slope = num * (top.spread + top.error), num * (modulus(top.slope) + top.slope_spread)
    rounding = 4 * ROUND * ratio * ratio
    return Dual(
        delta.value,
        widened(delta.error + rounding * size),
        widened(delta.spread + swing * (size + wide) + rounding * size),
        delta.slope,
        widened(delta.slope_spread + swing * slope + rounding * slope),
    )


@kernel
def enclose(
    plant: PlantDiscs,
    row: FloatArray,
    terms: int,
    num: float,
    den: float,
    centre: FloatArray,
    half: FloatArray,
    slopes: FloatArray,
    spreads: FloatArray,
    power: int,
) -> Enclosed:
    """Enclose num·|n|² − den·|d|² over a box, and its gradient.

    Parameters
    ----------
    plant
        Ŷ over the box, the extra gain left out.
    row, terms
        The figure's coefficients over the box's frequencies, and its number of shifts.
    num, den
        Weights of numerator and denominator, not negative: 1 and γ², say.
    centre, half
        ``(SIDES,)`` the box.
    slopes, spreads
        ``(SIDES,)``, filled with the gradient: within ``spreads`` of ``slopes`` over the box.
    power
        The power of μ by which |n|² is to be multiplied: 0 or 2.
    """
    omega, ratio, delay = centre[OMEGA], centre[RATIO], centre[DELAY]
    alpha = _weighed(row, terms + ALPHA_N, terms + ALPHA_D, num, den)
    mass = ratio**power  # of the numerator
    delta = _weighed(row, terms + DELTA_N, terms + DELTA_D, num * mass, den)
    both = _weighed(row, terms + BETA_N, terms + BETA_D, num, den)
    reach = abs(omega) * half[DELAY] + (delay + half[DELAY]) * half[OMEGA] + half[PHASE]
    turn = turning_disc(omega * delay + centre[PHASE], widened(reach))
    beta, moving = product(disc_of(both), turn), product(slope_of(both), turn)
    plant = _amplified(plant, centre[GAIN], half[GAIN])
    whole = plant.whole  # Ŷ
    size = modulus(whole.value)
    square = size * size
    square_error = (2 * size + whole.error) * whole.error + 4 * ROUND * square
    square_spread = (2 * size + whole.spread) * whole.spread + 4 * ROUND * square
    turned, level = product(beta, whole), alpha.value.real  # βY
    force = Disc(  # half of what F's gradient by Y is
        complex(whole.value.real, -whole.value.imag) * level + beta.value,
        0.0,
        abs(level) * whole.spread
        + alpha.spread * (size + whole.spread)
        + beta.spread
        + 4 * ROUND * (abs(level) * size + modulus(beta.value)),
    )
    ahead = twice_real(lagging(turned), 1.0, 0.0)
    slopes[PHASE], spreads[PHASE] = ahead
    slopes[GAIN], spreads[GAIN] = twice_real(product(force, whole), 1.0, 0.0)
    slopes[RATIO], spreads[RATIO] = twice_real(product(force, plant.by_ratio), 1.0, 0.0)
    if power:
        top = stored(row, terms + DELTA_N)
        slopes[RATIO] += 2 * ratio * num * top.value.real
        spreads[RATIO] += _swing_of_slope(top, num, ratio, half[RATIO])
        delta = _swung(delta, top, num, ratio, half[RATIO])
    tau_a = twice_real(product(force, plant.by_tau_a), 1.0, 0.0)
    tau_b = twice_real(product(force, plant.by_tau_b), 1.0, 0.0)
    late = twice_real(product(force, plant.by_delay), 1.0, 0.0)
    fast = twice_real(product(force, plant.by_omega), 1.0, 0.0)
    own = product(moving, whole)
    slopes[TAU_A], spreads[TAU_A] = tau_a
    slopes[TAU_B], spreads[TAU_B] = tau_b
    slopes[DELAY] = late[0] + omega * ahead[0]
    spreads[DELAY] = late[1] + abs(omega) * ahead[1] + half[OMEGA] * (abs(ahead[0]) + ahead[1])
    slopes[OMEGA] = fast[0] + delay * ahead[0]
    slopes[OMEGA] += alpha.slope.real * square + 2 * own.value.real + delta.slope.real
    spreads[OMEGA] = fast[1] + delay * ahead[1] + half[DELAY] * (abs(ahead[0]) + ahead[1])
    spreads[OMEGA] += alpha.slope_spread * (square + square_spread) + 2 * own.spread
    spreads[OMEGA] += abs(alpha.slope.real) * square_spread + delta.slope_spread
    parts = abs(fast[0]) + (delay + abs(omega)) * abs(ahead[0]) + abs(late[0])
    parts += abs(alpha.slope.real) * square + 2 * modulus(own.value) + abs(delta.slope.real)
    for i in range(SIDES):
        spreads[i] = widened(spreads[i] + 8 * ROUND * abs(slopes[i]))
    spreads[OMEGA] += 8 * ROUND * parts
    spreads[DELAY] += 8 * ROUND * parts
    value = level * square + 2 * turned.value.real + delta.value.real
    rounding = abs(level) * square + 2 * modulus(turned.value) + abs(delta.value.real)
    rounding *= 4 * ROUND
    error = alpha.error * (square + square_error) + abs(level) * square_error
    spread = alpha.spread * (square + square_spread) + abs(level) * square_spread
    return Enclosed(
        value,
        widened(error + 2 * turned.error + delta.error + rounding),
        widened(spread + 2 * turned.spread + delta.spread + rounding),
    )
