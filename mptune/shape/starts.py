"""Parameters to start from: they must stabilise every loop."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mptune.arrays import FloatArray
    from mptune.shape.problem import Problem

_HALVINGS = 12
_CROSSOVERS = 16
_GAIN = 0.3  # |L| of the proportional part at the frequency tried as crossover
_SPLITS = (0.1, 0.01)  # of every other part at the same frequency, over the proportional one


def stabilising_starts(problem: Problem, start: FloatArray | None) -> Iterator[FloatArray]:
    """Yield parameters that stabilise every loop; the given ones first if they do.

    Tried in turn: the given start, the start with smaller gains and still smaller integral gains,
    and gains within the bounds that make |L| equal to 0.3 at one frequency after another, from the
    highest down, of either sign where the bounds allow it.
    """
    return (candidate for candidate in _candidates(problem, start) if problem.stable(candidate))


def _candidates(problem: Problem, start: FloatArray | None) -> Iterator[FloatArray]:
    structure = problem.structure
    integral = np.array(structure.integral)
    if start is not None and np.any(start != 0):
        yield start
        for halving in range(1, _HALVINGS + 1):
            share = 0.5**halving
            yield start * np.where(integral, share**2, share)
            yield start * np.where(integral, share**2, 1.0)
    loops = next(iter(problem.loops.values()))
    places = np.linspace(0, len(loops.omega) - 1, _CROSSOVERS).astype(int)[::-1]
    signs = (1.0, -1.0) if min(structure.low) < 0 else (1.0,)
    basis = np.abs(structure.response(loops.omega))
    first = int(np.argmin(integral))  # the first function without integral action
    for place in places:
        reach = np.abs(loops.plant[:, place]).max() * basis[:, place]
        reach = np.maximum(reach, 1e-300)
        for split in _SPLITS:
            size = _GAIN * split / reach
            size[first] = _GAIN / reach[first]
            for sign in signs:
                yield np.clip(sign * size, structure.low, structure.high)
