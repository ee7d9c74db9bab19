"""Closed-loop poles of rational loops with dead time, counted with certainty.

χ = A·D + B·N·e^{−sd} has no poles, and its zeros in the right half plane are the closed loop's
poles there. Along the upper imaginary axis the argument of A·D would turn by π/2 for every root in
the left half plane and by −π/2 for every other; what χ turns less than that is counted (Mikhailov):

    zeros = (turned(ω) + arg((1 + L(jω))/(1 + L(∞))) − Δ arg χ(0 … jω)) / π

with ω so high that |L − L(∞)| < |1 + L(∞)| beyond it in the right half plane; ``turned`` is the
argument of A·D at ω gathered from its roots. Poles of the open loop need not be told apart: light
modes, integrators and poles on the axis are roots like others. The change of argument over an
interval is taken as its principal value where χ is proved to stay within a disc that does not hold
0; else the interval is split. A loop for which this does not end is undecided, which is no proof
of instability but counts as not stable.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import BoolArray, FloatArray, IntArray, frozen
from mptune.loops.stability import PoleCount

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.shape.rational_loops import RationalLoops

_CLOSE = 0.5  # of |1 + L(∞)|, that L is from L(∞) where the axis ends
_DOUBLINGS = 80
_ROUNDS = 120
_MOST = 400_000  # intervals
_SMALLEST = 1e-14  # of its frequency, that an interval may become short
_NOTHING = 1e-30  # of the end of the axis: roots below count as 0 in the first subdivision
_POINTS = 60  # of the first subdivision, beside the loops' own
_DECADES = 4.0  # of the first subdivision, below the end of the axis


class Intervals(NamedTuple):
    """Intervals of the frequency axis [rad/s], and the loop that each belongs to, ``(I,)``."""

    rows: IntArray
    low: FloatArray
    high: FloatArray

    @property
    def centre(self) -> FloatArray:
        """Their centres."""
        return np.asarray(0.5 * (self.low + self.high))

    @property
    def radius(self) -> FloatArray:
        """Half widths that reach both ends, rounding included."""
        return np.asarray(0.5 * (self.high - self.low) * (1 + 1e-15) + 1e-15 * self.high)

    @classmethod
    def of(cls, edges: Sequence[FloatArray], ends: FloatArray) -> Intervals:
        """Return the axis from 0 to each end ``(N,)``, first divided at its edges below it."""
        parts = []
        for row, (edge, end) in enumerate(zip(edges, ends, strict=True)):
            own = np.geomspace(end * 10**-_DECADES, end, _POINTS)
            points = np.unique(
                np.concatenate([[0.0], edge[(edge > _NOTHING * end) & (edge < end)], own])
            )
            parts.append((np.full(len(points) - 1, row), points[:-1], points[1:]))
        return cls(*(np.concatenate(part) for part in zip(*parts, strict=True)))

    def only(self, mask: BoolArray) -> Intervals:
        """Return some of them."""
        return Intervals(self.rows[mask], self.low[mask], self.high[mask])

    def split(self) -> Intervals:
        """Return the halves, by logarithm where the ends are far apart; from 0 an eighth."""
        middle = np.where(self.high > 4 * self.low, np.sqrt(self.low * self.high), self.centre)
        middle = np.where(self.low == 0, self.high / 8, middle)
        return Intervals(
            np.concatenate([self.rows, self.rows]),
            np.concatenate([self.low, middle]),
            np.concatenate([middle, self.high]),
        )

    @property
    def divisible(self) -> BoolArray:
        """Which are still long enough to be split."""
        return np.asarray(self.high - self.low > _SMALLEST * self.high)


def axis_end(loops: RationalLoops) -> FloatArray:
    """Return where the tail of each loop begins ``(N,)`` [rad/s]; infinite where it never does."""
    omega = 2 * loops.reach
    far = loops.tail(omega * 2.0**_DOUBLINGS)
    share = np.maximum(_CLOSE, 0.5 * (1 + far.radius / np.maximum(np.abs(1 + far.centre), 1e-300)))
    for _ in range(_DOUBLINGS):
        tail = loops.tail(omega)
        todo = ~(tail.radius < share * np.abs(1 + tail.centre))
        if not np.any(todo):
            return omega
        omega = np.where(todo, 2 * omega, omega)
    return np.where(todo | (share >= 1), np.inf, omega)


def count_closed_poles(loops: RationalLoops) -> PoleCount:
    """Count the closed-loop poles in the right half plane of every loop, ``(N,)``."""
    end = axis_end(loops)
    decided = np.isfinite(end)
    end = np.where(decided, end, 2 * loops.reach)
    turned, complete = _argument(loops, Intervals.of(loops.edges, end))
    every = np.arange(len(loops))
    parts = loops.parts(every, end, np.zeros(len(loops)))
    with np.errstate(divide="ignore", invalid="ignore"):
        difference = parts.characteristic.value / parts.open_loop.value
        closure = np.angle(difference / (1 + loops.tail(end).centre))
    poles = (loops.turned(end) + closure - turned) / np.pi
    whole = np.rint(np.where(np.isfinite(poles), poles, -1.0))
    decided &= complete & (np.abs(poles - whole) < 1e-3) & (whole >= 0)
    return PoleCount(frozen(whole.astype(np.int64)), frozen(decided))


def _argument(loops: RationalLoops, todo: Intervals) -> tuple[FloatArray, BoolArray]:
    """Return the change of the argument of χ over the intervals ``(N,)``, and its certainty."""
    angle = np.zeros(len(loops))
    complete = np.ones(len(loops), np.bool_)
    for _ in range(_ROUNDS):
        enclosed = loops.parts(todo.rows, todo.centre, todo.radius).characteristic
        certain = enclosed.smallest > 0
        angle += _change(loops, todo.only(certain))
        left = todo.only(~certain)
        complete[left.rows[~left.divisible]] = False
        todo = left.only(complete[left.rows])
        if not len(todo.rows) or len(todo.rows) > _MOST:
            break
        todo = todo.split()
    complete[todo.rows] = False
    return angle, complete


def _change(loops: RationalLoops, done: Intervals) -> FloatArray:
    """Return the sum of the principal values of the changes of argument, ``(N,)``."""
    still = np.zeros(len(done.rows))
    low = loops.parts(done.rows, done.low, still).characteristic.value
    high = loops.parts(done.rows, done.high, still).characteristic.value
    change = np.angle(high * low.conj())
    return np.bincount(done.rows, change, minlength=len(loops)).astype(np.float64)
