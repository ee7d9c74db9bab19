"""The polish: a gradient-based search for what is not convex, from a good start.

The objective is a largest value (of a peak error over plants, moves and windows of time), which has
kinks wherever two of them tie, and ties are where its optimum lies. So each value is a constraint
of its own under a bound that is minimised: a smooth problem, for SLSQP. Derivatives are forward
differences of the whole vector of values, backward ones at an upper bound. SLSQP ends where an
absolute step of the objective is small: the objective is taken relative to the start's.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.optimize import minimize

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.arrays import BoolArray, FloatArray

_STEP = 1e-5  # of the forward differences, on logarithmic scales
ITERATIONS = 150
_PRECISION = 1e-6
_MET = 1e-6  # an excess that counts as none
_SAME = 1e-4  # of the objective: two points that differ by less are worth the same
_WORTHLESS = 1e3  # stands for values that are not finite, those of a loop that runs away


class Values(NamedTuple):
    """What a point is worth.

    Attributes
    ----------
    peaks
        ``(E,)`` values whose largest is part of the objective.
    smooth
        The objective's other part.
    excesses
        ``(C,)`` logarithms of found over allowed, at most 0 where a requirement is kept.
    """

    peaks: FloatArray
    smooth: float
    excesses: FloatArray

    @property
    def cost(self) -> float:
        """The objective."""
        return self.smooth + (float(self.peaks.max()) if len(self.peaks) else 0.0)

    @property
    def feasible(self) -> bool:
        """Whether every requirement is kept."""
        return bool(self.excesses.max(initial=-1.0) <= _MET)


@dataclass(frozen=True)
class Polished:
    """Where a polish ended.

    Attributes
    ----------
    point
        ``(K,)`` on the search's scales: the best point seen that keeps the requirements, or the
        one nearest to keeping them.
    values
        What it is worth.
    converged
        Whether SLSQP met its own criterion, first-order stationary, at a point that is worth what
        the returned one is.
    evaluations
        Points looked at.
    """

    point: FloatArray
    values: Values
    converged: bool
    evaluations: int


class _Search:
    """One search: remembers the last point's values and derivatives, and the best point."""

    def __init__(
        self, evaluate: Callable[[FloatArray], Values], high: FloatArray, relieved: BoolArray
    ) -> None:
        self._evaluate, self._high, self._relieved = evaluate, high, relieved
        self._at: FloatArray | None = None
        self._slopes_at: FloatArray | None = None
        self.evaluations = 0
        self.merit = (np.inf, np.inf)  # of the best point: requirements first
        self.best = np.zeros(0)
        self.best_values = Values(np.zeros(0), np.inf, np.zeros(0))

    def values(self, point: FloatArray) -> Values:
        if self._at is None or not np.array_equal(point, self._at):
            self._at, self._known = point.copy(), self._look(point)
        return self._known

    def slopes(self, point: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the derivatives of peaks ``(E, K)``, smooth part ``(K,)``, excesses ``(C, K)``."""
        if self._slopes_at is None or not np.array_equal(point, self._slopes_at):
            base = self.values(point)
            steps = np.where(point + _STEP <= self._high, _STEP, -_STEP)
            moved = [self._look(point + step) for step in np.diag(steps)]
            self._slopes_at = point.copy()
            self._slopes = (
                np.stack([one.peaks - base.peaks for one in moved], 1) / steps,
                np.array([one.smooth - base.smooth for one in moved]) / steps,
                np.stack([one.excesses - base.excesses for one in moved], 1) / steps,
            )
        return self._slopes

    def ends_at_best(self, point: FloatArray) -> bool:
        """Return whether a point is worth what the best one is."""
        over, cost = self._merit(self.values(point))
        best_over, best_cost = self.merit
        return over <= best_over + _SAME and abs(cost - best_cost) <= _SAME * max(1, abs(best_cost))

    def _look(self, point: FloatArray) -> Values:
        self.evaluations += 1
        found = self._evaluate(point)
        merit = self._merit(found)
        if merit < self.merit:
            self.merit, self.best, self.best_values = merit, point.copy(), found
        return found

    def _merit(self, found: Values) -> tuple[float, float]:
        """Return what a point is worth: how far it is from what must be kept, and its objective."""
        if self._relieved.any():
            relieved = float(found.excesses[self._relieved].max())
            kept = found.excesses[~self._relieved].max(initial=-1.0)
            return max(float(kept), _MET), relieved
        return max(float(found.excesses.max(initial=-1.0)), _MET), found.cost


def _scaled(values: Values, scale: float) -> Values:
    """Return the values with the objective scaled, and those that are not finite replaced."""
    peaks, excesses = (
        np.nan_to_num(one, nan=_WORTHLESS, posinf=_WORTHLESS, neginf=-_WORTHLESS)
        for one in (values.peaks, values.excesses)
    )
    smooth = values.smooth if np.isfinite(values.smooth) else _WORTHLESS
    return Values(scale * peaks, scale * smooth, excesses)


def polish(
    evaluate: Callable[[FloatArray], Values],
    start: FloatArray,
    low: FloatArray,
    high: FloatArray,
    relieved: BoolArray | None = None,
    iterations: int = ITERATIONS,
) -> Polished:
    """Return the best point near the start.

    Parameters
    ----------
    evaluate
        The values of a point ``(K,)``; smooth functions in fixed order and number.
    start
        A first point ``(K,)``; it need not keep the requirements.
    low, high
        Bounds ``(K,)``.
    relieved
        ``(C,)`` true for excesses to be made small instead of the objective, the others kept: how
        far a requirement would have to give.
    iterations
        How many at most.
    """
    first = _scaled(evaluate(start), 1.0)
    if len(start) == 0:
        return Polished(start, first, converged=True, evaluations=1)
    unit = abs(first.cost) or 1.0
    first = _scaled(first, 1 / unit)
    give = np.zeros(len(first.excesses), np.bool_) if relieved is None else relieved
    search = _Search(lambda point: _scaled(evaluate(point), 1 / unit), high, give)
    relief = bool(give.any())
    count = len(start)

    def objective(y: FloatArray) -> float:
        return float(y[-1]) + (0.0 if relief else search.values(y[:-1]).smooth)

    def gradient(y: FloatArray) -> FloatArray:
        smooth = np.zeros(count) if relief else search.slopes(y[:-1])[1]
        return np.append(smooth, 1.0)

    def room(y: FloatArray) -> FloatArray:
        found = search.values(y[:-1])
        over = np.where(give, found.excesses - y[-1], found.excesses)
        return np.concatenate([np.zeros(0) if relief else y[-1] - found.peaks, -over])

    def room_slopes(y: FloatArray) -> FloatArray:
        peaks, _, excesses = search.slopes(y[:-1])
        of_peaks = np.column_stack([-peaks, np.ones(len(peaks))]) if not relief else None
        of_rest = np.column_stack([-excesses, give.astype(np.float64)])
        return of_rest if of_peaks is None else np.concatenate([of_peaks, of_rest])

    unbounded = (None, None) if relief or len(first.peaks) else (0.0, 0.0)
    bound = float(first.excesses[give].max()) if relief else float(first.peaks.max(initial=0.0))
    result = minimize(
        objective,
        np.append(start, bound),
        jac=gradient,
        method="SLSQP",
        bounds=[*zip(low, high, strict=True), unbounded],
        constraints={"type": "ineq", "fun": room, "jac": room_slopes},
        options={"maxiter": iterations, "ftol": _PRECISION},
    )
    converged = bool(result.success) and search.ends_at_best(result.x[:-1])
    best = _scaled(search.best_values, unit)
    return Polished(search.best, best, converged, search.evaluations)
