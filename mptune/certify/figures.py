"""Every figure as |n_0 + n_1 Y| / |d_0 + d_1 Y|, its four coefficients functions of ω alone.

Y is what the plant does: ṽ = μ G_F e^{−jωd} with μ = m_N/m, or a sum of such values at shifted
frequencies for the loop as it runs (``mptune.certify.sampled``), or what a state estimator hears of
place and force (``mptune.certify.estimated``). With P = s m_N/K_P,vel,
R = (1 + τs)², G_P = Q/(sR), W and h the denominator and the numerator of the position filter
behind the median's sample, and D = Eq. 23 over s (W = h = D = 1 without a path):

=================  =======================  =================================================
figure             numerator                denominator
=================  =======================  =================================================
Eq. 17             hD (ṽ − e_0)             PW + e_0 hD
Eq. 21             PW Qh (ṽ − e_0)          (PW + hDṽ) (Qh e_0 + s²R (PW + e_0 hD))
velocity loop      S: PW, T: hDṽ            S + T
loop at F_ref      S: s²R PW, T: the rest   s²R PW + ṽh (s²RD + Q) = S + T
position loop      S: s²R (PW + hDṽ)        that of the loop at F_ref = S + T
compliance         μ s²R PW/P²              that of the loop at F_ref
=================  =======================  =================================================

e_0 = e^{−jωd_N}. As S + T = 1, a peak of S, of T or of (S − T)/2 is one mixture of both. All
coefficients are analytic at ω = 0, and the denominators do not vanish there: where K_I = 0, or
K_P,pos = 0 as well, Q and s²R are divided by the s, or by the s²R, that they then share.

The compliance, |S|/(mω²) without its unit, is the only figure whose numerator knows the mass: its
μ is not a row's but the search's. That numerator is sRW K_P,vel/m_N, no pole at ω = 0.

The search asks for the sign of |n|² − γ²|d|² = α|Y|² + 2 Re(βY) + δ, so that what is kept of a
figure per interval of ω (a ``row``) is α, β and δ of numerator and denominator.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from mptune.arrays import FloatArray, kernel
from mptune.certify.aliases import differentiator, sampled_law, sampled_terms
from mptune.certify.balls import (
    ROUND,
    Dual,
    conjugate,
    constant,
    modulus,
    plus,
    polynomial,
    scaled,
    squared_modulus,
    times,
    turning,
    widened,
)
from mptune.certify.estimated import continuous_pair, sampled_pairs
from mptune.certify.form import COMPLIANCE, EQUATION_17, MIXTURE, Form
from mptune.certify.rows import (
    ALPHA_D,
    ALPHA_N,
    BETA_D,
    BETA_N,
    D_0,
    D_1,
    DELTA_D,
    DELTA_N,
    store,
)
from mptune.loops.broken import POSITION, SAMPLED, VELOCITY


class _Parts(NamedTuple):
    """n_0, n_1, d_0, d_1."""

    n0: Dual
    n1: Dual
    d0: Dual
    d1: Dual


@kernel
def coefficients(
    form: Form,
    shifts: FloatArray,
    curve: FloatArray,
    omega: float,
    half: float,
    row: FloatArray,
) -> None:
    """Fill a row with the coefficients over |ω − omega| ≤ half.

    Parameters
    ----------
    form
        The figure.
    shifts
        ``(J,)`` what each term's frequency is above ω [rad/s]; a single 0 but for SAMPLED.
    curve
        ``(B, 2)`` frequencies [rad/s] and largest allowed ratios that the figure is divided by;
        the interval holds no corner of it. Empty for none.
    omega, half
        Centre and half width of the interval [rad/s].
    row
        ``(row_length(J),)``.
    """
    if form.loop == SAMPLED:
        first, law = sampled_law(form, omega, half)
        if form.path.estimator_mass > 0:
            sampled_pairs(form, shifts, first, law, omega, half, row)
        else:
            sampled_terms(form, shifts, first, law, omega, half, row)
        open_loop = times(_integrated(form, omega, half), first)
        parts = _mixture(form, open_loop, constant(0.0), constant(1.0))
        if form.figure == COMPLIANCE:
            soft = softened(form, omega, half)
            if form.path.estimator_mass > 0:  # its numerator is that of ``softness``
                soft = parts.d0
            parts = _Parts(soft, parts.n1, parts.d0, parts.d1)
    elif form.path.estimator_mass > 0:
        first, law = shape_of(form, omega, half)
        below = continuous_pair(form, len(shifts), first, law, omega, half, row)
        open_loop = times(times(_integrated(form, omega, half), first), below)
        parts = _mixture(form, open_loop, constant(0.0), constant(1.0))
        if form.figure == COMPLIANCE:
            parts = _Parts(parts.d0, parts.n1, parts.d0, parts.d1)  # see ``softness``
    else:
        store(row, len(shifts) - 1, constant(1.0))
        parts = _continuous(form, omega, half)
    if len(curve) > 0:
        allowed = _allowed(curve, omega, half)
        parts = _Parts(parts.n0, parts.n1, times(parts.d0, allowed), times(parts.d1, allowed))
    terms = len(shifts)
    store(row, terms + ALPHA_N, squared_modulus(_tightened(parts.n1, half)))
    store(row, terms + ALPHA_D, squared_modulus(_tightened(parts.d1, half)))
    store(row, terms + DELTA_N, squared_modulus(_tightened(parts.n0, half)))
    store(row, terms + DELTA_D, squared_modulus(_tightened(parts.d0, half)))
    store(row, terms + BETA_N, times(conjugate(parts.n0), parts.n1))
    store(row, terms + BETA_D, times(conjugate(parts.d0), parts.d1))
    store(row, terms + D_0, _tightened(parts.d0, half))
    store(row, terms + D_1, _tightened(parts.d1, half))


@kernel
def _tightened(a: Dual, half: float) -> Dual:
    """Return the dual with the spread that its slope allows, where that is less."""
    reach = widened((modulus(a.slope) + a.slope_spread) * half + a.error)
    return Dual(a.value, a.error, min(a.spread, reach), a.slope, a.slope_spread)


@kernel
def _integrated(form: Form, omega: float, half: float) -> Dual:
    """Return P = s m_N/K_P,vel."""
    time = form.nominal.mass / form.gains.k_p_vel
    return scaled(polynomial(omega, half, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0), time)


@kernel
def _mixture(form: Form, s0: Dual, s1: Dual, t1: Dual) -> _Parts:
    """Return the parts of x S + y T over S + T, where S = s_0 + s_1 Y and T = t_1 Y."""
    x, y = form.share_s, form.share_t
    return _Parts(scaled(s0, x), plus(scaled(s1, x), scaled(t1, y)), s0, plus(s1, t1))


@kernel
def shape_of(form: Form, omega: float, half: float) -> tuple[Dual, Dual]:
    """Return s²R and Q, over what both share: s where K_I = 0, s²R without any gain."""
    if form.gains.k_i_pos == 0 and form.gains.k_p_pos == 0:
        return constant(1.0), constant(0.0)
    k_p, twice, square = form.gains.k_p_pos, 2 * form.gains.tau, form.gains.tau * form.gains.tau
    damping, stiffness = (
        2 * form.gains.xi / form.gains.omega,
        1 / (form.gains.omega * form.gains.omega),
    )
    if form.gains.k_i_pos == 0:
        first = polynomial(omega, half, 0.0, 1.0, twice, square, 0.0, 0.0)
        return first, polynomial(omega, half, k_p, k_p * damping, k_p * stiffness, 0.0, 0.0, 0.0)
    k_i = form.gains.k_i_pos
    q1, q2 = k_p + k_i * twice, k_p * damping + k_i * square
    first = polynomial(omega, half, 0.0, 0.0, 1.0, twice, square, 0.0)
    return first, polynomial(omega, half, k_i, q1, q2, k_p * stiffness, 0.0, 0.0)


@kernel
def softened(form: Form, omega: float, half: float) -> Dual:
    """Return s²R P/P², the path left out, over what s²R and Q share; under Tustin as it runs."""
    rate, tau = form.gains.k_p_vel / form.nominal.mass, form.gains.tau
    if form.loop == SAMPLED:
        turn = turning(omega, half, form.period)
        change = scaled(plus(constant(1.0), scaled(turn, -1.0)), 1 / form.period)  # (1 − w)/T_S
        lag = plus(scaled(change, 2 * tau), plus(constant(1.0), turn))
        lags = scaled(times(lag, lag), rate)
        return lags if form.gains.k_i_pos == 0 else times(lags, change)
    if form.gains.k_i_pos == 0:
        return scaled(polynomial(omega, half, 1.0, 2 * tau, tau * tau, 0.0, 0.0, 0.0), rate)
    return scaled(polynomial(omega, half, 0.0, 1.0, 2 * tau, tau * tau, 0.0, 0.0), rate)


@kernel
def _continuous(form: Form, omega: float, half: float) -> _Parts:
    """Return the parts of every figure but those of the loop as it runs."""
    first, law = shape_of(form, omega, half)
    plant = _integrated(form, omega, half)  # P
    speed = constant(1.0)
    if form.path.sample_time > 0:
        tick = turning(omega, half, form.path.sample_time)
        plant = times(plant, plus(constant(1.0), scaled(tick, -form.path.filter_pole)))  # PW
        place = scaled(tick, 1 - form.path.filter_pole)  # h
        speed = times(place, differentiator(form, omega, half))  # hD
        law = times(place, law)  # Qh
    if form.figure == MIXTURE and form.loop == VELOCITY:
        return _mixture(form, plant, constant(0.0), speed)
    s0, s1 = times(first, plant), times(first, speed)
    if form.figure == MIXTURE and form.loop == POSITION:
        return _mixture(form, s0, s1, law)
    if form.figure in (MIXTURE, COMPLIANCE):
        parts = _mixture(form, s0, constant(0.0), plus(s1, law))
        if form.figure == COMPLIANCE:
            soft = softened(form, omega, half)
            if form.path.sample_time > 0:
                lag = plus(constant(1.0), scaled(turning(omega, half, form.path.sample_time),
                                                 -form.path.filter_pole))  # fmt: skip
                soft = times(soft, lag)  # W
            parts = _Parts(soft, parts.n1, parts.d0, parts.d1)
        return parts
    nominal = turning(omega, half, form.nominal.delay)
    if form.figure == EQUATION_17:
        closed = times(nominal, speed)
        return _Parts(scaled(closed, -1.0), speed, plus(plant, closed), constant(0.0))  # Eq. 17
    top = times(plant, law)
    closed = plus(s0, times(nominal, plus(s1, law)))
    return _Parts(
        scaled(times(top, nominal), -1.0), top, times(plant, closed), times(speed, closed)
    )  # Eq. 21


@kernel
def _allowed(curve: FloatArray, omega: float, half: float) -> Dual:
    """Return the largest allowed ratio: linear over ln ω between the corners, else constant."""
    last = len(curve) - 1
    if omega <= curve[0, 0]:
        return constant(curve[0, 1])
    if omega >= curve[last, 0]:
        return constant(curve[last, 1])
    k = 0
    while omega > curve[k + 1, 0]:
        k += 1
    length = math.log(curve[k + 1, 0] / curve[k, 0])
    rate = (curve[k + 1, 1] - curve[k, 1]) / length
    value, slope = curve[k, 1] + rate * math.log(omega / curve[k, 0]), rate / omega
    rounding = 8 * ROUND * (curve[k, 1] + curve[k + 1, 1] + abs(rate))
    bend = half / (omega - half)
    return Dual(
        complex(value, 0.0),
        rounding,
        widened(abs(rate) * bend + rounding),
        complex(slope, 0.0),
        widened(abs(slope) * (bend + 8 * ROUND * (1 + 1 / length))),
    )
