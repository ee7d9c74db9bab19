"""First-order lags advanced exactly over a step of an input that is a cubic in time.

With b(t) the cubic that the lag settles to, its answer is b(t) + C e^{−t/τ}, and that can be
integrated once and twice in closed form. A time constant of 0 passes the input on. Where the same
step is taken again and again, what becomes of e^{−t/τ} over it is found once, as a ``Fade``: an
exponential costs more than all the rest.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mptune.arrays import kernel


class Cubic(NamedTuple):
    """c_0 + c_1 t + c_2 t² + c_3 t³, t from the begin of a step."""

    c0: float
    c1: float
    c2: float
    c3: float


class Fade(NamedTuple):
    """e^{−t/τ} over a step h."""

    tau: float  # s, τ
    left: float  # e^{−h/τ}, at the end
    once: float  # s, its integral over the step, τ (1 − e^{−h/τ})
    rest: float  # s, h less that: times τ, its second integral


class Lagged(NamedTuple):
    """A lag's answer over one step: a cubic and what decays on the way to it."""

    settled: Cubic
    decaying: float  # C


@kernel
def fade_of(tau: float, step: float) -> Fade:
    """Return what becomes of e^{−t/τ} over a step [s]; nothing of a lag of no time."""
    left = np.exp(-step / tau) if tau > 0 else 0.0
    once = tau * (1 - left)
    return Fade(tau, left, once, step - once)


@kernel
def hermite(start: float, slope_start: float, end: float, slope_end: float, step: float) -> Cubic:
    """Return the cubic through two values with two slopes, a step apart [s]."""
    rise = (end - start) / step
    return Cubic(
        start,
        slope_start,
        (3 * rise - 2 * slope_start - slope_end) / step,
        (slope_start + slope_end - 2 * rise) / step**2,
    )


@kernel
def value_and_slope(cubic: Cubic, t: float) -> tuple[float, float]:
    """Return value and slope of a cubic."""
    c0, c1, c2, c3 = cubic
    return c0 + t * (c1 + t * (c2 + t * c3)), c1 + t * (2 * c2 + t * 3 * c3)


@kernel
def integral(cubic: Cubic, t: float) -> float:
    """Return the integral of a cubic from 0."""
    return t * (cubic.c0 + t * (cubic.c1 / 2 + t * (cubic.c2 / 3 + t * cubic.c3 / 4)))


@kernel
def lagged(start: float, tau: float, wanted: Cubic) -> Lagged:
    """Return the answer of a lag τ [s] that stands at ``start``."""
    b3 = wanted.c3
    b2 = wanted.c2 - 3 * tau * b3
    b1 = wanted.c1 - 2 * tau * b2
    b0 = wanted.c0 - tau * b1
    return Lagged(Cubic(b0, b1, b2, b3), start - b0 if tau > 0 else 0.0)


@kernel
def lag_end(lag: Lagged, fade: Fade, step: float) -> tuple[float, float, float]:
    """Return a lag's value after the step, and its first and second integral over it."""
    b0, b1, b2, b3 = lag.settled
    h, decaying = step, lag.decaying
    twice = h * h * (b0 / 2 + h * (b1 / 6 + h * (b2 / 12 + h * b3 / 20)))
    return (
        value_and_slope(lag.settled, h)[0] + decaying * fade.left,
        integral(lag.settled, h) + decaying * fade.once,
        twice + decaying * fade.tau * fade.rest,
    )


@kernel
def held_lag_end(
    start: float, wanted: float, fade: Fade, step: float
) -> tuple[float, float, float]:
    """Return what ``lag_end`` does where the input stands still, in a third of the time."""
    decaying = start - wanted
    return (
        wanted + decaying * fade.left,
        wanted * step + decaying * fade.once,
        wanted * step * step / 2 + decaying * fade.tau * fade.rest,
    )
