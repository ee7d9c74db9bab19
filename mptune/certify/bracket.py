"""Enclose the number up to which something is safe, by proofs below it and failures above it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mptune.certify.result import Bracket, Stability

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.certify.problem import Point

    Verdict = Callable[[float, float], tuple[Stability, Point | None, int]]

_STEPS = 80


def bracket(
    verdict: Verdict, start: float, tolerance: float, floor: float, limit: float
) -> Bracket:
    """Return the bracket of the largest number up to which all is safe.

    Parameters
    ----------
    verdict
        Given a number and a lower one up to which all is known to be safe (0 to begin with), says
        whether the same is proved up to the number (STABLE), or something fails at it (UNSTABLE,
        with the place), or neither; and how many boxes that took.
    start
        Where to begin.
    tolerance
        How far apart both ends may be, relative to the lower one.
    floor
        Numbers below it are not told apart from zero.
    limit
        Numbers above it are not asked about: the bracket is then open upwards.
    """
    lower, refused, doubtful, upper = 0.0, math.inf, 0.0, math.inf
    at: Point | None = None
    boxes, asked = 0, start
    for _ in range(_STEPS):
        status, place, taken = verdict(asked, lower)
        boxes += taken
        if status is Stability.STABLE:
            lower = max(lower, asked)
        else:
            refused = min(refused, asked)
        if status is Stability.UNSTABLE:
            upper, at = asked, place
        else:
            doubtful = max(doubtful, asked)
        if refused > (1 + tolerance) * max(lower, floor):
            low, high = lower, refused
        else:  # proofs have come as far as they will: bring failures down to them
            low, high = max(doubtful, lower), upper
        if low >= limit or high <= max(floor, (1 + tolerance) * low):
            break
        asked = _between(low, high, floor, limit)
    closed = upper <= (1 + tolerance) * max(lower, floor) or lower >= limit
    return Bracket(lower, upper, at, closed, boxes)


def _between(low: float, high: float, floor: float, limit: float) -> float:
    """Return the number to ask about next: half-way in logarithm, at most a factor of 2."""
    if math.isinf(high):
        return min(2 * low, limit)
    return max(math.sqrt(low * high), high / 2) if low > 0 else max(high / 2, floor)
