"""Where the frequency axis may be cut: beyond it every figure is known to be small.

With p = ω m_N/K_P,vel, l = μ_max/p, C = K_P(1/ω_c² + 2ξ/(ω_c ω) + 1/ω²)/τ² + K_I/ω,
l_F = l(1 + C/ω) and q = C/(ω(p − 1)), all falling with ω wherever p > 1::

    Eq. 17 ≤ (1 + μ_max)/(p − 1)            Eq. 21 ≤ (1 + μ_max)/(1 − l) · q/(1 − q)
    velocity loop   S ≤ 1/(1 − l)           T ≤ l/(1 − l)
    F_ref           S ≤ 1/(1 − l_F)         T ≤ l_F/(1 − l_F)
    position loop   S ≤ (1 + l)/(1 − l_F)   T ≤ (l C/ω)/(1 − l_F)
    compliance      ≤ μ_max/p² · 1/(1 − l_F)

and |S − T|/2 ≤ (S + T)/2. They hold with and without a measurement path, whose responses are at
most 1 in modulus, as |G_F| is. The loop as it runs has no tail: it repeats itself. Around a state
estimator l_F is the bound of ``mptune.loops.estimated``; the axis ends at half the fast rate.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mptune.certify.form import COMPLIANCE, EQUATION_17, EQUATION_21
from mptune.loops.broken import POSITION, VELOCITY
from mptune.loops.estimated import falling_bound, half_rate

if TYPE_CHECKING:
    from mptune.certify.form import Form

_CARE = 1 + 1e-9  # what roundings of the formulas below may come to, and far more
_STEPS = 60


def tail_start(form: Form, ratio: float, level: float) -> float:
    """Return a frequency [rad/s] beyond which the figure is at most ``level``.

    Parameters
    ----------
    form
        The figure, of a loop that is not sampled.
    ratio
        The largest m_N/m of the box.
    level
        The level, above 0; for S above 1, and for (S − T)/2 above 1/2.
    """
    if form.path.estimator_mass > 0:
        return _estimated_start(form, ratio, level)
    low, high = 0.0, 2 * ratio * form.gains.k_p_vel / form.nominal.mass
    while not tail_bound(form, ratio, high) <= level:
        low, high = high, 2 * high
    for _ in range(_STEPS):
        middle = 0.5 * (low + high)
        small = tail_bound(form, ratio, middle) <= level
        low, high = (low, middle) if small else (middle, high)
    return high


def tail_bound(form: Form, ratio: float, omega: float) -> float:
    """Return what the figure is at most at ``omega`` [rad/s] and beyond; infinite if unknown."""
    gains = form.gains
    turn = omega * form.nominal.mass / gains.k_p_vel  # p
    loop = ratio / turn  # l
    shape = 1 / gains.omega**2 + 2 * gains.xi / (gains.omega * omega) + 1 / omega**2
    law = (gains.k_p_pos * shape / gains.tau**2 + gains.k_i_pos / omega) / omega  # C/ω
    whole = loop * (1 + law)  # l_F
    if turn <= 1 or loop >= 1:
        return float("inf")
    if form.figure == EQUATION_17:
        return _CARE * (1 + ratio) / (turn - 1)
    if form.figure == EQUATION_21:
        nominal = law / (turn - 1)  # q
        if nominal >= 1:
            return float("inf")
        return _CARE * (1 + ratio) / (1 - loop) * nominal / (1 - nominal)
    if form.figure == COMPLIANCE:
        return _CARE * ratio / turn**2 / (1 - whole) if whole < 1 else float("inf")
    return _mixture_bound(form, loop, law, whole)


def _estimated_start(form: Form, ratio: float, level: float) -> float:
    """Return the same around a state estimator: at most half the fast rate."""
    mass = form.nominal.mass / ratio
    low, high = 1e-3, half_rate(form.path)
    for _ in range(_STEPS):
        middle = math.sqrt(low * high)
        whole = falling_bound(middle, mass, form.gains, form.path)
        small = math.isfinite(whole) and _estimated_bound(form, ratio, middle, whole) <= level
        low, high = (low, middle) if small else (middle, high)
    return high


def _estimated_bound(form: Form, ratio: float, omega: float, whole: float) -> float:
    if form.figure == COMPLIANCE:
        turn = omega * form.nominal.mass / form.gains.k_p_vel  # p
        soft = ratio * (1 + whole) / turn**2  # |L_F| is among the terms that |L| is bounded by
        return _CARE * soft / (1 - whole) if whole < 1 else float("inf")
    return _mixture_bound(form, whole, 0.0, whole)


def _mixture_bound(form: Form, loop: float, law: float, whole: float) -> float:
    top_s, top_t, rest = 1.0, whole, 1 - whole
    if form.loop == VELOCITY:
        top_t, rest = loop, 1 - loop
    elif form.loop == POSITION:
        top_s, top_t = 1 + loop, loop * law
    if rest <= 0:
        return float("inf")
    return _CARE * (abs(form.share_s) * top_s + abs(form.share_t) * top_t) / rest
