"""The frequencies of a design: where its plants move, at their poles and zeros, and beyond."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.errors import Fault, InputError
from mptune.shape.rational import landmarks
from mptune.shape.responses import own_range

if TYPE_CHECKING:
    from mptune.arrays import ComplexArray, FloatArray
    from mptune.shape.problem import Loops
    from mptune.shape.responses import Response
    from mptune.shape.structure import Structure

_SETTLED = 0.1  # of |L| at the upper end, and of |S| − 1 at the lower
_PER_DECADE = 60  # where a root lies beyond the plant's own range


def common_grid(
    nominal: Response, others: list[Response], structure: Structure, omega: FloatArray | None
) -> FloatArray:
    """Return the common frequencies ``(F,)`` [rad/s].

    Those of sampled plants; else the given, or the nominal plant's own, and with either the points
    at and about the poles and zeros of every plant and of the controller where they are known.
    """
    sampled = [one.omega for one in (nominal, *others) if one.omega is not None]
    if sampled:
        if any(not np.array_equal(one, sampled[0]) for one in sampled):
            rule = "is sampled at other frequencies than the plant"
            raise InputError("design", Fault("family", "", rule, "use the same"))
        return sampled[0]
    own = landmarks(np.roots(structure.denominator)) if structure.denominator else np.zeros(0)
    marks = np.unique(np.concatenate([own, *(one.landmarks for one in (nominal, *others))]))
    if omega is not None:
        given = np.asarray(omega, np.float64)
        return np.union1d(given, marks[(marks > given.min()) & (marks < given.max())])
    return _extended(own_range(nominal, "plant"), marks)


def _extended(grid: FloatArray, marks: FloatArray) -> FloatArray:
    """Return a grid with marks added, and filled up to those beyond its ends."""
    parts = [grid, marks]
    for near, far in ((grid[0], marks.min(initial=grid[0])), (grid[-1], marks.max(initial=0.0))):
        decades = abs(np.log10(far / near)) if far > 0 else 0.0
        if decades > 0 and not grid[0] <= far <= grid[-1]:
            parts.append(np.geomspace(near, far, int(np.ceil(_PER_DECADE * decades)) + 1)[1:])
    return np.unique(np.concatenate(parts))


def beyond(loops: Loops, gain: ComplexArray) -> FloatArray:
    """Return frequencies beyond the ends where |S| has not settled there.

    Parameters
    ----------
    loops
        The loops.
    gain
        Their gains L, ``(N, F)``.
    """
    low, high = loops.omega[0], loops.omega[-1]
    size = np.abs(1 / (1 + gain))
    moving = np.abs(np.diff(np.log(size[:, [0, 1, -2, -1]]), axis=1)).max(axis=0)
    added = np.zeros(0)
    if np.abs(gain[:, -1]).max() > _SETTLED and moving[2] > 0:
        added = np.geomspace(high, 10 * high, 60)[1:]
    if moving[0] > 0 and size[:, 0].max() > 1 + _SETTLED:
        added = np.concatenate([np.geomspace(low / 10, low, 60)[:-1], added])
    return added
