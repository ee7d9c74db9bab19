"""Parameters to start from: they must stabilise every loop."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mptune.arrays import FloatArray, IntArray
    from mptune.shape.problem import Loops, Problem

_HALVINGS = 12
_CROSSOVERS = 16
_APART = 3  # of these, from one integral start to the next: few, and far apart
_GAIN = 0.3  # |L| of the proportional part at the frequency tried as crossover
_SPLITS = (0.1, 0.01)  # of every other part at the same frequency, over the proportional one


def stabilising_starts(problem: Problem, start: FloatArray | None) -> Iterator[FloatArray]:
    """Yield parameters that stabilise every loop; the given ones first if they do.

    Tried in turn: the given start, the start with smaller gains and still smaller integral gains,
    and gains within the bounds that make |L| equal to 0.3 at one frequency after another, from the
    highest down, of either sign where the bounds allow it.
    """
    return (candidate for candidate in _candidates(problem, start) if problem.stable(candidate))


def integral_starts(problem: Problem) -> Iterator[FloatArray]:
    """Yield parameters that stabilise every loop with integral action almost alone.

    Every other parameter is 0, or at its bound next to 0, and the integral ones make |L| at most
    0.3 from one frequency after another on, from the highest down: below a resonance that a
    proportional part would feed, they begin with what the resonance bears.
    """
    structure = problem.structure
    integral = np.array(structure.integral)
    if not np.any(integral):
        return
    loops = next(iter(problem.loops.values()))
    gain = np.abs(structure.response(loops.omega)) * np.abs(loops.plant).max(axis=0)
    beyond = np.maximum.accumulate(gain[:, ::-1], axis=1)[:, ::-1]
    for place in _places(loops)[::_APART]:
        size = np.where(integral, _GAIN / np.maximum(beyond[:, place], 1e-300), 0.0)
        for sign in _signs(problem):
            candidate = np.clip(sign * size, structure.low, structure.high)
            if problem.stable(candidate):
                yield candidate


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
    basis = np.abs(structure.response(loops.omega))
    first = int(np.argmin(integral))  # the first function without integral action
    for place in _places(loops):
        reach = np.abs(loops.plant[:, place]).max() * basis[:, place]
        reach = np.maximum(reach, 1e-300)
        for split in _SPLITS:
            size = _GAIN * split / reach
            size[first] = _GAIN / reach[first]
            for sign in _signs(problem):
                yield np.clip(sign * size, structure.low, structure.high)


def _signs(problem: Problem) -> tuple[float, ...]:
    return (1.0, -1.0) if min(problem.structure.low) < 0 else (1.0,)


def _places(loops: Loops) -> IntArray:
    """Return places on the grid at even distances of the logarithm, from the highest down."""
    omega = loops.omega
    wanted = np.geomspace(omega[0], omega[-1], _CROSSOVERS) * (1 + 1e-12)
    return np.asarray(np.searchsorted(omega, wanted[::-1], side="right") - 1, np.int64)
