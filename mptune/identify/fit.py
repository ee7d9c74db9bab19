"""Eq. 11 and a dead time, fitted to a frequency response, with confidence.

The complex residuals are weighted by the coherence and their sum of squares is made least. Noise is
what is left over: the scale of the variance is taken from the residuals, and raised where those of
neighbouring frequencies resemble each other (a window's leakage, or what the model cannot follow).

Eq. 11 nearly is the same with τ_A and τ_B exchanged: its denominator is, and its numerator differs
by the difference of the piston areas only. So both orders are fitted, and where the worse one
cannot be excluded the intervals hold both. Where the intervals of the linear covariance are wide
they are no guide any more, and those of the sum of squares itself (``mptune.identify.region``) take
their place.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import frozen
from mptune.errors import Fault, InputError
from mptune.identify.fitted import NAMES, Certainty, Fit, Interval
from mptune.identify.region import likely_ends
from mptune.loops.force_dynamics import force_dynamics

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.arrays import ComplexArray, FloatArray
    from mptune.identify.response import FrequencyResponse

_SYMBOLS = ("τ_A", "τ_B", "d")
_FEWEST_POINTS = 6
_LEAST_VARIANCE = 1e-6  # relative, of a point whose coherence is 1
_CONFIDENCE = 0.95
_VAGUE = 0.25  # half width over value from which a parameter counts as ill determined
_STARTS = (2.0, 10.0)  # ms, of the smaller time constant
_APART = 4.0  # ms, of the larger one from it
_UNKNOWN = 1e3  # ms, where the linear covariance is singular
_ROUNDS = 2  # of weighting by the model's magnitude
_ORDERS = (
    np.array([[1.0, 0, 0], [1, 1, 0], [0, 0, 1]]),  # τ_A, then τ_B = τ_A + excess
    np.array([[1.0, 1, 0], [1, 0, 0], [0, 0, 1]]),
)


def model(omega: FloatArray, parameters: FloatArray, share_a: float) -> ComplexArray:
    """Return G_F(jω) e^{−jωd} at τ_A, τ_B and d [s]."""
    tau_a, tau_b, delay = parameters
    s = np.asarray(1j * omega, np.complex128)
    return np.asarray(force_dynamics(s, tau_a, tau_b, share_a) * np.exp(-s * delay))


def fit(
    response: FrequencyResponse, share_a: float, band: tuple[float, float] = (0.0, np.inf)
) -> Fit:
    """Fit τ_A, τ_B and dead time to one response.

    Parameters
    ----------
    response
        From force reference to force.
    share_a
        A_A/(A_A + A_B), known.
    band
        Lowest and highest frequency to fit [rad/s].

    Raises
    ------
    InputError
        If the response has too few points in the band.
    """
    used = response.valid & (response.omega >= band[0]) & (response.omega <= band[1])
    if used.sum() < _FEWEST_POINTS:
        rule = f"has {used.sum()} points in the band where {_FEWEST_POINTS} are needed at least"
        raise InputError(response.name, Fault("", "", rule, "widen the band or measure more"))
    data = _Data(response.omega[used], response.response[used], _variance(response)[used])
    best, other, deviation = _both_orders(data, share_a)
    quantile, excess = _quantiles(2 * len(data.omega) - len(NAMES))
    variance = _noise(data, best, deviation, share_a)
    order_open = other.cost - best.cost < excess * variance and _apart(best, other)
    covariance = variance * _covariance(best.jacobian)
    orders = (best, other) if order_open else (best,)
    each = [_ends(one.at, variance * _covariance(one.jacobian), quantile) for one in orders]
    either_determined = not any(
        _is_vague(of_one[0], of_one[1], one.at) for of_one, one in zip(each, orders, strict=True)
    )
    ends = np.stack([np.min(each, axis=0)[0], np.max(each, axis=0)[1]])
    if _is_vague(ends[0], ends[1], best.at):
        residuals = _residuals(data, deviation, share_a, 1e-3 * np.eye(3))
        minima = [1e3 * one.at for one in orders]
        ends = 1e-3 * likely_ends(residuals, minima, best.cost + excess * variance)
    low, high = ends
    intervals = [
        Interval(*(float(end) for end in one)) for one in zip(best.at, low, high, strict=True)
    ]
    vague = _is_vague(low, high, best.at)
    certainty = Certainty.ILL_DETERMINED if vague else Certainty.DETERMINED
    if order_open:
        certainty = Certainty.ORDER_UNKNOWN
    if not best.converged:
        certainty = Certainty.NOT_CONVERGED
    fitted = model(data.omega, best.at, share_a)
    return Fit(
        name=response.name,
        tau_a=intervals[0],
        tau_b=intervals[1],
        delay=intervals[2],
        covariance=frozen(covariance),
        points=len(data.omega),
        error=float(np.sqrt(np.mean(np.abs(data.response / fitted - 1) ** 2))),
        weakest=_weakest(covariance, quantile),
        certainty=certainty,
        either_order_determined=either_determined,
    )


class _Data(NamedTuple):
    omega: FloatArray  # (F,)
    response: ComplexArray  # (F,)
    variance: FloatArray  # (F,) relative, up to a common factor; NaN where not known


class _Minimum(NamedTuple):
    at: FloatArray  # (3,) τ_A, τ_B, delay
    cost: float  # weighted sum of squares
    jacobian: FloatArray  # (2F, 3) of the weighted residuals, in τ_A, τ_B and delay
    start: FloatArray  # (3,) where it was found, for the next round
    converged: bool


def _variance(response: FrequencyResponse) -> FloatArray:
    """Return the relative variance of each point, up to a common factor; NaN where not known."""
    quality = np.clip(response.quality, 1e-6, 1.0)
    return np.maximum((1 - quality) / quality, _LEAST_VARIANCE)


def _both_orders(data: _Data, share_a: float) -> tuple[_Minimum, _Minimum, FloatArray]:
    """Return the better and the worse of the fits with τ_A ≤ τ_B and with τ_B ≤ τ_A.

    With them comes the standard deviation of each point, ``(F,)``, up to a common factor.
    """
    known = ~np.isnan(data.variance)
    deviation = np.where(known, np.abs(data.response) * np.sqrt(data.variance), 1.0)
    minima = [_minimum(data, deviation, share_a, order) for order in _ORDERS]
    for _ in range(_ROUNDS):  # the model's magnitude is less noisy than the data's
        best = min(minima, key=lambda minimum: minimum.cost)
        magnitude = np.abs(model(data.omega, best.at, share_a))
        deviation[known] = (magnitude * np.sqrt(data.variance))[known]
        minima = [
            _minimum(data, deviation, share_a, order, found.start)
            for order, found in zip(_ORDERS, minima, strict=True)
        ]
    minima.sort(key=lambda minimum: minimum.cost)
    return minima[0], minima[1], deviation


def _noise(data: _Data, best: _Minimum, deviation: FloatArray, share_a: float) -> float:
    """Return the variance of the weighted residuals, raised where neighbours resemble."""
    degrees = 2 * len(data.omega) - len(NAMES)
    off = (model(data.omega, best.at, share_a) - data.response) / deviation
    power = float(np.sum(np.abs(off) ** 2))
    if power == 0:
        return float(np.finfo(float).tiny)
    alike = float(np.real(np.vdot(off[:-1], off[1:]))) / power
    alike = min(max(alike, 0.0), 0.95)
    return best.cost / degrees * (1 + alike) / (1 - alike)


def _minimum(
    data: _Data,
    deviation: FloatArray,
    share_a: float,
    order: FloatArray,
    start: FloatArray | None = None,
) -> _Minimum:
    """Return the best fit with the time constants in one order.

    ``order`` makes them, in milliseconds, of the smaller one and of the other's excess over it,
    both at least 0.
    """
    from scipy.optimize import least_squares

    scale = 1e-3 * order
    residuals = _residuals(data, deviation, share_a, scale)
    starts = [start] if start is not None else _starts(data)
    runs = [least_squares(residuals, one, bounds=(0, np.inf), x_scale="jac") for one in starts]
    best = min(runs, key=lambda run: run.cost)
    return _Minimum(
        at=scale @ best.x,
        cost=float(2 * best.cost),
        jacobian=best.jac @ np.linalg.inv(scale),
        start=best.x,
        converged=bool(best.success),
    )


def _residuals(
    data: _Data, deviation: FloatArray, share_a: float, scale: FloatArray
) -> Callable[[FloatArray], FloatArray]:
    """Return the weighted residuals ``(2F,)`` of points that ``scale`` makes parameters [s] of."""

    def residuals(point: FloatArray) -> FloatArray:
        off = (model(data.omega, scale @ point, share_a) - data.response) / deviation
        return np.concatenate([off.real, off.imag])

    return residuals


def _starts(data: _Data) -> list[FloatArray]:
    """Return starts in milliseconds; the dead time from the slope of the phase."""
    phase = np.unwrap(np.angle(data.response))
    lag = -1e3 * float(np.median(np.diff(phase) / np.diff(data.omega)))
    return [np.array([tau, _APART, max(lag - tau, 1.0)]) for tau in _STARTS]


def _quantiles(degrees: int) -> tuple[float, float]:
    """Return Student's for an interval, and Fisher's for the excess of a sum of squares."""
    from scipy import stats

    student = float(stats.t.ppf(0.5 + 0.5 * _CONFIDENCE, degrees))
    return student, float(stats.f.ppf(_CONFIDENCE, 1, degrees))


def _covariance(jacobian: FloatArray) -> FloatArray:
    """Return (JᵀJ)⁻¹; a direction without any effect has a huge variance rather than none."""
    _, size, directions = np.linalg.svd(jacobian, full_matrices=False)
    size = np.maximum(size, 1e-8 * size[0])
    return np.asarray((directions.T / size**2) @ directions)


def _ends(at: FloatArray, covariance: FloatArray, quantile: float) -> FloatArray:
    """Return the ends of the linear intervals, ``(2, 3)``, none negative."""
    width = quantile * np.sqrt(np.diag(covariance))
    return np.stack([np.maximum(at - width, 0.0), at + width])


def _is_vague(low: FloatArray, high: FloatArray, at: FloatArray) -> bool:
    """Whether some interval is too wide for its value."""
    return bool(np.any(high - low > 2 * _VAGUE * at))


def _apart(best: _Minimum, other: _Minimum) -> bool:
    """Whether two minima differ: at τ_A = τ_B both orders have the same one."""
    return bool(np.abs(best.at - other.at).max() > 1e-3 * best.at.max())


def _weakest(covariance: FloatArray, quantile: float) -> str:
    """Return the direction of largest variance in words: ``0.71 τ_A − 0.71 τ_B: ± 3.2 ms``."""
    variances, directions = np.linalg.eigh(covariance)
    direction = directions[:, -1] * np.sign(directions[np.argmax(np.abs(directions[:, -1])), -1])
    terms = [
        f"{'−' if share < 0 else '+'} {abs(share):.2f} {symbol}"
        for share, symbol in zip(direction, _SYMBOLS, strict=True)
        if abs(share) >= 0.05
    ]
    text = " ".join(terms).removeprefix("+ ")
    width = 1e3 * quantile * float(np.sqrt(variances[-1]))
    return f"{text}: ± {width:.2g} ms" if width < _UNKNOWN else f"{text}: not known to first order"
