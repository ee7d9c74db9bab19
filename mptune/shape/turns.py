"""Encirclements of sampled loops: what a frequency response alone can say about stability."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.errors import Fault
from mptune.loops.stability import PoleCount, poles_of_turns

if TYPE_CHECKING:
    from mptune.arrays import BoolArray, ComplexArray, FloatArray
    from mptune.shape.problem import Loops
    from mptune.shape.structure import Structure

_LARGE = 4.0  # |L| at the first frequency of a loop with poles at the origin
_TAIL = 0.5  # |L| at the last frequency
_STRAIGHT = np.pi / 4  # largest deviation from the asymptote's angle at the first frequency
_TURN = np.pi / 6  # of 1 + L, that a step far from −1 may take
_WITHIN = 0.25  # of a whole number: below the grid the angle is that of the asymptote
_POINTS = 2000  # of the count where loops are known at any frequency
_BEYOND = 1e3  # how far below and above the grid that count looks

_DOUBTS = {
    "coarse": Fault(
        "omega",
        "",
        "is too coarse to count encirclements: a step passes −1 at less than its own length",
        "give more frequencies near the crossover",
    ),
    "tail": Fault(
        "omega",
        "",
        "ends where the loop gain is not below 1/2, so that encirclements beyond are unknown",
        "give higher frequencies, or a controller whose gain falls off",
    ),
    "start": Fault(
        "omega",
        "",
        "begins where the loop does not yet follow its poles at the origin",
        "give lower frequencies, or the right number of integrators",
    ),
}


def count_sampled(loop: ComplexArray, integrators: int, unstable_poles: int = 0) -> PoleCount:
    """Count the closed-loop poles in the right half plane of sampled loops.

    Between two samples the loop is taken to go straight, which no samples can prove. The count is
    refused (undecided) where a step is longer than its distance from −1 and turns 1 + L by more
    than 30°, where |L| is not below 1/2 at the last frequency, and where the first frequency does
    not show the c/s^k of the open-loop poles at the origin.

    Parameters
    ----------
    loop
        ``(N, F)`` loop gains at rising frequencies.
    integrators
        Number k of open-loop poles at the origin.
    unstable_poles
        Number of open-loop poles in the right half plane.
    """
    gain = np.atleast_2d(loop)
    distance = 1 + gain
    change = np.angle(distance[:, 1:] / distance[:, :-1]).sum(axis=1)
    start, _ = _start(gain, integrators)
    decided = ~np.any(list(doubts(gain, integrators).values()), axis=0)
    return poles_of_turns(start + change, distance[:, -1], decided, unstable_poles, _WITHIN)


def doubts(loop: ComplexArray, integrators: int) -> dict[str, BoolArray]:
    """Return for each reason the loops ``(N,)`` whose count must be refused."""
    gain = np.atleast_2d(loop)
    distance = 1 + gain
    near = np.minimum(np.abs(distance[:, 1:]), np.abs(distance[:, :-1]))
    turn = np.abs(np.angle(distance[:, 1:] / distance[:, :-1]))
    long = (np.abs(np.diff(gain, axis=1)) > near) & (turn > _TURN)
    _, bent = _start(gain, integrators)
    begun = bent > _STRAIGHT
    if integrators:
        begun |= np.abs(gain[:, 0]) < _LARGE
    return {
        "coarse": np.any(long, axis=1),
        "tail": np.abs(gain[:, -1]) >= _TAIL,
        "start": np.asarray(begun, np.bool_),
    }


def _start(gain: ComplexArray, integrators: int) -> tuple[FloatArray, FloatArray]:
    """Return the angle of 1 + L gathered below the grid, and how far L is off its asymptote."""
    first = gain[:, 0]
    if not integrators:
        start = np.angle((1 + first) * np.where(first.real < -1, -1, 1))
        return start, np.abs(start)
    # The angle of L j^k is that of c in c/s^k: 0 or π.
    deviation = np.angle((first * 1j**integrators) ** 2) / 2
    with np.errstate(divide="ignore", invalid="ignore"):  # no gain at all is refused elsewhere
        closed = np.angle(1 + 1 / first)
    return -integrators * np.pi / 2 + deviation + closed, np.abs(deviation)


class SampledStability:
    """Whether parameters stabilise every loop, with the reasons where that cannot be told.

    Attributes
    ----------
    reasons
        Why counts were refused so far.
    """

    def __init__(
        self,
        structure: Structure,
        loops: dict[str, Loops],
        integrators: int,
        unstable_poles: int,
    ) -> None:
        self._structure, self._integrators = structure, integrators
        self._unstable_poles = unstable_poles
        self._loops = [_widened(one) for one in loops.values()]
        self._basis = [structure.response(one.omega) for one in self._loops]
        self._integral = np.array(structure.integral)
        self._found: set[str] = set()

    @property
    def reasons(self) -> tuple[Fault, ...]:
        """Why counts were refused so far."""
        return tuple(_DOUBTS[key] for key in sorted(self._found))

    def __call__(self, x: FloatArray) -> bool:
        """Return whether every loop is certainly stable."""
        integrators = self._integrators + int(np.any(x[self._integral] != 0))
        if not np.any(x):
            integrators = 0  # no loop gain at all
        stable = True
        for one, basis in zip(self._loops, self._basis, strict=True):
            gain = one.gain(x @ basis)
            count = count_sampled(gain, integrators, self._unstable_poles)
            stable &= bool(count.stable.all())
            if not count.decided.all():
                found = doubts(gain, integrators)
                self._found |= {key for key, mask in found.items() if mask.any()}
        return stable


def _widened(loops: Loops) -> Loops:
    """Return loops on a wider and finer grid where they are known at any frequency."""
    if loops.between is None:
        return loops
    low, high = loops.omega[0] / _BEYOND, loops.omega[-1] * _BEYOND
    added = np.setdiff1d(np.geomspace(low, high, _POINTS), loops.omega)
    return loops.refined(added)
