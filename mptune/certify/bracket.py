"""Enclose the number up to which something is safe, by proofs below it and failures above it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mptune.certify.result import Bracket, Stability

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.certify.problem import Point

    Verdict = Callable[[float], tuple[Stability, Point | None, int]]

_STEPS = 60


def bracket(
    verdict: Verdict, start: float, tolerance: float, floor: float, limit: float
) -> Bracket:
    """Return the bracket of the largest number that is safe.

    Parameters
    ----------
    verdict
        Says of a number whether all below it is proved safe (STABLE), it is known to fail
        (UNSTABLE, with the place), or neither; and how many boxes that took.
    start
        Where to begin.
    tolerance
        How far apart both ends may be, relative to the lower one.
    floor
        Numbers below it are not told apart from zero.
    limit
        Numbers above it are not asked about: the bracket is then open upwards.
    """
    lower, ceiling, upper = 0.0, math.inf, math.inf
    at: Point | None = None
    boxes, asked = 0, start
    for _ in range(_STEPS):
        status, place, taken = verdict(asked)
        boxes += taken
        if status is Stability.STABLE:
            lower = asked
        else:
            ceiling = asked
        if status is Stability.UNSTABLE:
            upper, at = asked, place
        nearest = min(ceiling, upper)
        if lower >= limit or nearest <= floor:
            break
        if nearest > (1 + tolerance) * max(lower, floor):
            asked = _between(lower, nearest, floor, limit)
        elif upper > (1 + tolerance) * nearest and math.isfinite(upper):
            asked = _between(nearest, upper, floor, limit)
        else:
            break
    closed = upper <= (1 + tolerance) * max(lower, floor) or lower >= limit
    return Bracket(lower, upper, at, closed, boxes)


def _between(low: float, high: float, floor: float, limit: float) -> float:
    """Return the number to ask about next: half-way in logarithm, at most a factor of 2."""
    if math.isinf(high):
        return min(2 * low, limit)
    return max(math.sqrt(low * high), high / 2) if low > 0 else max(high / 2, floor)
