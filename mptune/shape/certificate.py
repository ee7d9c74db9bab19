"""Guaranteed bounds of closed-loop functions over all frequencies, by branch and bound.

sup |n/d| ≤ γ exactly where |n|² < γ²|d|² everywhere: no division, and d ≠ 0 is implied. With n and
d enclosed as lines over an interval, both sides are parabolas in ω there and what is left is
bounded; an interval that this does not prove is halved. γ lies a small gap above the best value
attained so far; where that rises, earlier proofs stay valid. Beyond an end of the axis the bound
follows from the degrees alone.

The bound rests on the rounding of double precision as ``taylor`` states it, and holds for the poles
and zeros as they stand in the plants. Where the budget ends first, it is wider than the gap, and
the result says that it is open; it is a bound all the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mptune.shape.taylor import ROUND
from mptune.shape.winding import Intervals

if TYPE_CHECKING:
    from mptune.arrays import BoolArray, FloatArray
    from mptune.shape.rational_loops import Quotients
    from mptune.shape.taylor import Line

GAP = 1e-7  # of the attained value, between it and the bound
_ROUNDS = 120
_MOST = 400_000  # intervals
_DOUBLINGS = 40


@dataclass(frozen=True)
class Supremum:
    """The supremum of N closed-loop functions over all frequencies, between two numbers.

    Attributes
    ----------
    attained
        The largest value found.
    frequency, row
        Where [rad/s], and of which function; a value that is only approached as the frequency
        vanishes or grows is named at a very low or very high one.
    bound
        What no value exceeds; infinite where none is known.
    closed
        Whether the two are within the gap asked for.
    """

    attained: float
    frequency: float
    row: int
    bound: float
    closed: bool


def supremum(quotients: Quotients, begin: FloatArray, floor: float, gap: float = GAP) -> Supremum:
    """Return the supremum of |n/d| over all rows and frequencies.

    Parameters
    ----------
    quotients
        The functions, analytic in the right half plane: of stable loops.
    begin
        ``(N,)`` least frequency at which the tail may begin [rad/s].
    floor
        Above 0: a bound below is not asked for, since rounding may hide the function there.
    gap
        The relative gap between attained value and bound that is asked for.
    """
    best = _Best(gap, floor)
    first = Intervals.of(quotients.edges, begin)
    best.meet(first, *quotients.lines(first.rows, first.centre, first.radius))
    end, beyond = _tail(quotients, begin, best)
    todo = Intervals.of(quotients.edges, end)
    left = 0.0
    for _ in range(_ROUNDS):
        upper, lower = quotients.lines(todo.rows, todo.centre, todo.radius)
        best.meet(todo, upper, lower)
        proven = _below(best.bound, upper, lower)
        open_ = ~proven & ~todo.divisible
        if np.count_nonzero(~proven) > _MOST:
            open_ = ~proven
        left = max(left, _crude(upper, lower, open_))
        todo = todo.only(~proven & ~open_)
        if not len(todo.rows):
            break
        todo = todo.split()
    else:
        left = np.inf
    bound = max(best.bound, beyond, left)
    closed = bound <= max(best.attained * (1 + 2 * gap), floor)
    return Supremum(best.attained, best.frequency, best.row, float(bound), bool(closed))


class _Best:
    """The best value so far."""

    def __init__(self, gap: float, floor: float) -> None:
        self._gap, self._floor = gap, floor
        self.attained, self.frequency, self.row = 0.0, 0.0, 0

    @property
    def bound(self) -> float:
        """What is to be proved."""
        return max(self.attained * (1 + self._gap), self._floor)

    def meet(self, intervals: Intervals, upper: Line, lower: Line) -> None:
        """Look at the centres of some intervals."""
        size, floor = np.abs(upper.value), np.abs(lower.value)
        with np.errstate(divide="ignore", invalid="ignore"):
            value = np.nan_to_num(size / floor, nan=0.0, posinf=np.inf)
        place = int(np.argmax(value))
        if value[place] > self.attained:
            self.attained = float(value[place])
            self.frequency = float(intervals.centre[place])
            self.row = int(intervals.rows[place])


def _tail(quotients: Quotients, begin: FloatArray, best: _Best) -> tuple[FloatArray, float]:
    """Return where each tail is proved to begin, and the largest bound beyond."""
    end, tail = begin, quotients.beyond(begin)
    for _ in range(_DOUBLINGS):
        todo = tail > best.bound
        if not np.any(todo):
            break
        end = np.where(todo, 2 * end, end)
        tail = quotients.beyond(end)
    return end, float(tail.max())


def _below(gamma: float, upper: Line, lower: Line) -> BoolArray:
    """Return where |upper| < γ|lower| throughout the interval.

    With n = n_0 + n_1 x and d = d_0 + d_1 x the difference |n|² − γ²|d|² is a parabola in x, whose
    largest value over |x| ≤ 1 is taken, and what n and d may be off by is added to it.
    """
    n = np.abs(upper.value) + np.abs(upper.move)
    d = gamma * (np.abs(lower.value) + np.abs(lower.move))
    unit = np.maximum(np.maximum(n, d), 1e-300)  # keeps the squares from overflowing
    n_0, n_1 = upper.value / unit, upper.move / unit
    d_0, d_1 = gamma * lower.value / unit, gamma * lower.move / unit
    constant = np.abs(n_0) ** 2 - np.abs(d_0) ** 2
    linear = np.abs(2 * np.real(n_0.conj() * n_1 - d_0.conj() * d_1))
    square = np.abs(n_1) ** 2 - np.abs(d_1) ** 2
    inside = linear < -2 * square
    vertex = np.zeros_like(linear)
    np.divide(linear**2, -4 * square, out=vertex, where=inside)
    top = constant + np.where(inside, vertex, linear + square)
    n, d = n / unit, d / unit
    rest_n, rest_d = upper.rest / unit, gamma * lower.rest / unit
    off = rest_n * (2 * n + rest_n) + 2 * rest_d * d
    return np.asarray(top + off * (1 + 16 * ROUND) + 16 * ROUND * (n**2 + d**2) < 0)


def _crude(upper: Line, lower: Line, where: BoolArray) -> float:
    """Return a bound of the quotient over some intervals, from the enclosures alone."""
    if not np.any(where):
        return 0.0
    most, least = upper.largest[where], lower.smallest[where]
    if not (np.all(least > 0) and np.all(np.isfinite(most))):
        return np.inf
    return float(np.max(most / least))
