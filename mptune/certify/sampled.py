r"""The loop as it runs, as a sum of values of the plant at shifted frequencies.

Everything runs at a whole fraction of T_S, so that what the controller reads repeats itself with
the sampling rate: the loop gain at F_ref is, with ω_k = ω + 2πk/T_S and w = e^{−jωT_S}, ::

    L = (μ K_P,vel/m_N) Σ_k (1 − w)/(T_S jω_k) · f_k/(jω_k)² · (jω_k D_k + C) G_F(jω_k) e^{−jω_k d'}

the hold's response, the filter's f behind the median, Eq. 23 as jωD, and C, Eq. 22 under Tustin,
which is the same in all of them; d' = d − T_S/2, as the total delay counts the hold's half. With
y = (1 − w)/T_S, U = 1 + w, A = (2τy + U)² and B = K_P(4y²/ω_c² + 4ξyU/ω_c + U²) ::

    C = B/A + K_I U/(2y)

and L times jωyA·jω is a sum of coefficients that are analytic at ω = 0, with
sinc(ωT_S/2)(−1)^k e^{−jω_k d} for the hold and the delay together.

The sum is taken over |k| ≤ K. What is left out of L up to a frequency is at most ``remainder``,
whatever the plant: every |G_F| ≤ 1; filter and Eq. 23 are bounded band by band, the latter by its
taps and by the distance to the nearest multiple of the fast rate; with Ω = (2/T_S) tan(ωT_S/2),
|1 − w| ≤ ωT_S and |(1 − w)C| ≤ |1 − w| K_P (|1 − Ω²/ω_c²| + 2ξΩ/ω_c)/(1 + τ²Ω²) + K_I T_S.

A remainder δ moves S by δ|S||S_true|, and T and (S − T)/2, which differ from S by a constant, by as
much. A bound γ of the loop itself therefore follows from γ − δ(γ + c)² of the truncated one, c
being 0 for S, 1 for T and 1/2 for (S − T)/2, as |S| ≤ 1 + |T| and |S| ≤ 1/2 + |S − T|/2. For the
compliance, whose weight w = μ/|P|² does not know L, w/|1 + L| ≤ γ follows from |1 + L'| ≥ w/γ + δ
of the truncated one, that is from w/|1 + L'| ≤ γ/(1 + δγ/w).

What a load does to the position at its own frequency is (1 + L − L_0)S/(mω²), L_0 being the sum's
term k = 0: the compliance stands for it within |L − L_0|, less than 1e-3 where it has its peak; at
the shifted frequencies it does less still.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from mptune.certify.folded import LeftOut, left_out_of, unfolded_shifts
from mptune.certify.form import COMPLIANCE
from mptune.loops.broken import SAMPLED

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.certify.form import Form
    from mptune.params.packed import MeasurementPath

_TAPS = 18 / 35  # Σ|taps| of Eq. 23, times T_S,fast
MOST_SHIFTS = 100
ESTIMATED_TERMS = 4  # around a state estimator: what folds leave out is more than further ones do
_BANDS = 400  # bounded one by one; beyond them, together
_CARE = 1 + 1e-9  # more than all roundings of these sums


def shifts_of(form: Form, count: int) -> FloatArray:
    """Return the frequencies of a form's terms above ω [rad/s]."""
    if form.path.estimator_mass > 0 and form.loop == SAMPLED:
        return unfolded_shifts(count, form.path, form.period)
    return shifts_up_to(count, form.period)


def shifts_up_to(count: int, period: float) -> FloatArray:
    """Return the frequencies of the terms above ω [rad/s]: k = 0, 1, −1, …, count, −count."""
    order = [0, *(sign * k for k in range(1, count + 1) for sign in (1, -1))]
    return 2 * np.pi / period * np.array(order, np.float64)


def terms_for(form: Form, ratio: float, omega: float, allowed: float) -> int:
    """Return the K that leaves a remainder of at most ``allowed`` up to ``omega`` [rad/s].

    Where none up to ``MOST_SHIFTS`` does, that one is returned.
    """
    if form.path.estimator_mass > 0:
        return ESTIMATED_TERMS
    count = 2
    while remainder(form, ratio, count, omega) > allowed and count < MOST_SHIFTS:
        count += 1
    return count


def remainder(form: Form, ratio: float, count: int, omega: float) -> float:
    """Return what the terms beyond ``count`` add to L at most, at frequencies up to ``omega``.

    Parameters
    ----------
    form
        The loop.
    ratio
        The largest m_N/m of the box.
    count
        K, at least 1.
    omega
        The highest frequency [rad/s].
    """
    change, law = _law_bounds(form, omega)
    heard, placed = _series(form.path, form.period, count)
    plant = ratio * form.gains.k_p_vel / form.nominal.mass
    return _CARE * plant / form.period * (change * heard + law * placed)


def left_out(form: Form, ratio: float, count: int, omega: float) -> LeftOut:
    """Return the same around a state estimator, where it depends on the plants' lags."""
    return left_out_of(form, ratio, count, omega, *_law_bounds(form, omega))


def _law_bounds(form: Form, omega: float) -> tuple[float, float]:
    """Return bounds of |1 − w| and of |(1 − w)C| up to ``omega``."""
    gains, half = form.gains, omega * form.period / 2
    change = min(2.0, 2 * half)  # |1 − w|
    warped = 2 / form.period * math.tan(half) if half < 0.49 * math.pi else math.inf
    corner = warped / gains.omega
    lag = 1 / (gains.omega * gains.tau)
    shape = max(1.0, min(corner, lag) ** 2) + gains.xi * min(2 * corner, lag)
    return change, change * gains.k_p_pos * shape + gains.k_i_pos * form.period


@lru_cache(maxsize=1024)
def _series(path: MeasurementPath, period: float, count: int) -> tuple[float, float]:
    """Return Σ|f_k||Eq. 23| /|ω_k|³ and Σ|f_k|/|ω_k|³ over |k| > count."""
    rate, taps = 2 * math.pi / period, _TAPS / path.sample_time
    heard = placed = 0.0
    for k in range(count + 1, _BANDS + 1):
        low, high = (k - 0.5) * rate, (k + 0.5) * rate  # |ω_k| lies between them
        filtered = _filter_bound(path, low * path.sample_time, high * path.sample_time)
        placed += 2 * filtered / low**3
        heard += 2 * filtered * min(_distance(path, low, high), taps) / low**3
    beyond = 1 / (rate**3 * (_BANDS - 0.5) ** 2)
    return heard + taps * beyond, placed + beyond


def _distance(path: MeasurementPath, low: float, high: float) -> float:
    """Return how far a frequency of a band is at most from a multiple of the fast rate [rad/s]."""
    fast = 2 * math.pi / path.sample_time
    nearest = fast * round((low + high) / 2 / fast)
    return max(abs(low - nearest), abs(high - nearest))


def _filter_bound(path: MeasurementPath, low: float, high: float) -> float:
    """Return the filter's largest response between two angles ωT_S,fast."""
    turn = 2 * math.pi
    whole = math.floor(high / turn) > math.floor(low / turn)
    cosine = 1.0 if whole else max(math.cos(low), math.cos(high))
    pole = path.filter_pole
    return (1 - pole) / math.sqrt(max(1 + pole * pole - 2 * pole * cosine, (1 - pole) ** 2))


def truncated_bound(form: Form, bound: float, left_out: float, weight: float) -> float:
    """Return the bound of the truncated loop's figure from which that of the loop follows.

    Not positive where there is none. ``weight`` is the least μ/|P|², of a compliance.
    """
    if form.figure == COMPLIANCE:
        return bound / (1 + _CARE * left_out * bound / weight)
    return bound - _CARE * left_out * (bound + offset_of(form)) ** 2


def offset_of(form: Form) -> float:
    """Return c: 0 for S, 1 for T, 1/2 for (S − T)/2."""
    return 0.0 if form.share_t == 0 else 1.0 if form.share_s == 0 else 0.5
