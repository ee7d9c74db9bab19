"""How far each parameter may go before a fit is significantly worse than the best.

At τ_A = τ_B the linear covariance of Eq. 11 is singular, and where a response says little it is no
guide to how far the parameters may go. The sum of squares is: one parameter is moved away from the
best fit, the others following, until the sum passes its limit (profile likelihood).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.arrays import FloatArray

_FARTHEST = 1e3  # ms, where the search for an end is given up
_BISECTIONS = 7


def likely_ends(
    residuals: Callable[[FloatArray], FloatArray], minima: list[FloatArray], limit: float
) -> FloatArray:
    """Return the ends of each parameter's interval, ``(2, P)``.

    Parameters
    ----------
    residuals
        Weighted residuals of parameters ``(P,)``, all at least 0, in units of their usual size.
    minima
        Fits ``(P,)`` that cannot be excluded, the best among them.
    limit
        Largest sum of squares inside the region.

    Returns
    -------
    FloatArray
        Least and greatest values, a last step of bisection outwards: on the safe side.
    """
    table = np.stack(minima)
    ends = np.empty((2, table.shape[1]))
    for index in range(table.shape[1]):
        least, greatest = np.argmin(table[:, index]), np.argmax(table[:, index])
        ends[0, index] = _end(residuals, index, -1.0, table[least], limit)
        ends[1, index] = _end(residuals, index, 1.0, table[greatest], limit)
    return ends


def _end(
    residuals: Callable[[FloatArray], FloatArray],
    index: int,
    sign: float,
    start: FloatArray,
    limit: float,
) -> float:
    inside, step = start, max(0.05 * float(start[index]), 0.05)
    while True:
        outside = min(max(float(inside[index]) + sign * step, 0.0), _FARTHEST)
        cost, point = _followed(residuals, index, outside, inside)
        if cost > limit:
            break
        if outside in {0.0, _FARTHEST}:
            return outside
        inside, step = point, 2 * step
    for _ in range(_BISECTIONS):
        middle = 0.5 * (float(inside[index]) + outside)
        cost, point = _followed(residuals, index, middle, inside)
        if cost > limit:
            outside = middle
        else:
            inside = point
    return outside


def _followed(
    residuals: Callable[[FloatArray], FloatArray], index: int, value: float, start: FloatArray
) -> tuple[float, FloatArray]:
    """Return the least sum of squares with one parameter held, and where it is."""
    from scipy.optimize import least_squares

    free = np.arange(len(start)) != index
    point = start.copy()
    point[index] = value

    def held(others: FloatArray) -> FloatArray:
        point[free] = others
        return residuals(point)

    found = least_squares(held, np.maximum(start[free], 1e-9), bounds=(0, np.inf))
    point[free] = found.x
    return float(2 * found.cost), point.copy()
