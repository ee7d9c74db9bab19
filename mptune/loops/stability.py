"""Closed-loop stability of loops with dead time, by counting encirclements.

A loop with dead time has infinitely many poles, so stability is decided by the argument principle:
the number of closed-loop poles in the right half plane is the number of open-loop ones minus the
turns that 1 + L makes about the origin along the Nyquist contour. Three things keep the count from
being fooled:

* **Steps.** Between two points of the imaginary axis the change of angle is taken as its principal
  value only where it is certain to be: the loop states a bound on how far its gain can move over
  the step, and the step is split until that is less than the distance to the critical point.
* **Indentation.** Open-loop poles at the origin are passed on a small half circle on their right.
  Its radius is shrunk until the loop is its leading term c/s^k to within one half on the whole
  circle (then, by the maximum principle, inside too): no closed-loop pole hides within, and the
  change of angle along it is known in closed form.
* **Closure.** Beyond the loop's stated tail frequency |L| ≤ 1/2 throughout the right half plane, so
  that the large arc adds no turn.

A loop that passes so near the critical point that steps shrink to nothing is reported as undecided
and counts as not stable.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from mptune.arrays import BoolArray, ComplexArray, FloatArray, IntArray, frozen

_BASE_POINTS = 97  # per loop, before splitting
_SMALLEST = 1e-12  # step over frequency below which splitting is given up
_MOST_STEPS = 4096  # of one loop under way at once: then its splitting is given up too
_CERTAIN = 0.9  # share of the distance to the critical point that a step may use up
_CIRCLE: ComplexArray = np.exp(2j * np.pi * np.arange(64) / 64)


class DeadTimeLoop(Protocol):
    """N loops L(s), strictly proper in the right half plane, whose growth can be bounded."""

    @property
    def integrators(self) -> int:
        """Number k of open-loop poles at the origin."""
        ...

    @property
    def leading(self) -> FloatArray:
        """``(N,)``: the real c in L(s) → c/s^k as s → 0; unused where k = 0."""
        ...

    @property
    def radius(self) -> FloatArray:
        """``(N,)``: of a disc about the origin that holds no other open-loop pole [rad/s]."""
        ...

    @property
    def tail(self) -> FloatArray:
        """``(N,)``: frequency beyond which |L(s)| ≤ 1/2 wherever Re s ≥ 0 [rad/s]."""
        ...

    def response(self, s: ComplexArray, rows: IntArray) -> ComplexArray:
        """Return L(s[i]) of loop rows[i]."""
        ...

    def bound(self, omega: FloatArray, rows: IntArray) -> FloatArray:
        """Return S, the sum of the moduli of terms that add up to L(jω)."""
        ...

    def rate(self, omega: FloatArray, rows: IntArray) -> FloatArray:
        """Return Λ, a bound of every term's |d ln/dω| at ω and beyond.

        Then L moves by at most S (e^{Λh} − 1) over a step h.
        """
        ...


@dataclass(frozen=True)
class PoleCount:
    """Closed-loop poles in the right half plane, ``(N,)``, and whether each count is certain."""

    unstable: IntArray
    decided: BoolArray

    @property
    def stable(self) -> BoolArray:
        """``(N,)``: certainly no closed-loop pole in the right half plane."""
        return np.asarray(self.decided & (self.unstable == 0))


def count_unstable_poles(loop: DeadTimeLoop, open_loop_poles: int = 0) -> PoleCount:
    """Count the closed-loop poles of 1 + L in the right half plane.

    Parameters
    ----------
    loop
        The loops.
    open_loop_poles
        Number of open-loop poles in the right half plane, the same for all.

    Returns
    -------
    PoleCount
        The counts; undecided where the contour meets the critical point.
    """
    count = len(loop.tail)
    every = np.arange(count)
    start, indentation, decided = _indentation(loop, every)
    turned, reached = _angle_along_axis(loop, start)
    end = _return_difference(loop, np.maximum(loop.tail, 2 * start), every)
    return poles_of_turns(indentation + turned, end, decided & reached, open_loop_poles)


def poles_of_turns(
    turned: FloatArray,
    end: ComplexArray,
    decided: BoolArray,
    open_loop_poles: int = 0,
    within: float = 1e-3,
) -> PoleCount:
    """Return the pole counts that 1 + L means by its turns about the origin.

    Parameters
    ----------
    turned
        ``(N,)`` change of angle [rad] from the positive real axis' side of the indentation up along
        the imaginary axis: half the contour.
    end
        ``(N,)`` the last 1 + L, from where it goes to 1 without another turn.
    decided
        ``(N,)`` whether that angle is certain.
    open_loop_poles
        Number of open-loop poles in the right half plane.
    within
        How far from a whole number the count may be before it is undecided.
    """
    poles = open_loop_poles - (turned - np.angle(end)) / np.pi  # twice the half contour, over 2π
    whole = np.rint(poles)
    certain = decided & (np.abs(poles - whole) < within) & (whole >= 0)
    return PoleCount(frozen(whole.astype(np.int64)), frozen(certain))


def _indentation(loop: DeadTimeLoop, every: IntArray) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Return start of the axis, change of angle along the quarter circle, and certainty."""
    order = loop.integrators
    if order == 0:
        return np.zeros(len(every)), np.zeros(len(every)), np.ones(len(every), np.bool_)
    radius = 0.5 * np.minimum(loop.radius, loop.tail)
    todo = every
    for _ in range(200):
        points = radius[todo, None] * _CIRCLE
        rows = np.broadcast_to(todo[:, None], points.shape)
        gain = loop.response(points.ravel(), rows.ravel()).reshape(points.shape)
        leading = loop.leading[todo, None] / points**order
        near = np.all(np.abs(gain / leading - 1) <= 0.5, axis=1)
        large = np.abs(leading[:, 0]) >= 4
        todo = todo[~(near & large)]
        if len(todo) == 0:
            break
        radius[todo] *= 0.5
    decided = np.ones(len(every), np.bool_)
    decided[todo] = False
    axis = np.asarray(1j * radius, np.complex128)
    gain = loop.response(axis, every)
    deviation = gain * axis**order / loop.leading
    angle = -order * np.pi / 2 + np.angle(deviation) + np.angle(1 + 1 / gain)
    return radius, angle, decided


def _angle_along_axis(loop: DeadTimeLoop, start: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Return the change of angle of 1 + L from each start to its tail, and certainty."""
    count = len(start)
    tail = np.maximum(loop.tail, 2 * start)
    first = np.where(start > 0, start, 1e-3 * tail)
    steps = np.linspace(0.0, 1.0, _BASE_POINTS)
    grid = first[:, None] * (tail / first)[:, None] ** steps
    if loop.integrators == 0:
        grid = np.concatenate([np.zeros((count, 1)), grid], axis=1)
    rows = np.repeat(np.arange(count), grid.shape[1] - 1)
    low, high = grid[:, :-1].ravel(), grid[:, 1:].ravel()
    values = _return_difference(loop, grid.ravel(), np.repeat(np.arange(count), grid.shape[1]))
    values = values.reshape(grid.shape)
    at_low, at_high = values[:, :-1].ravel(), values[:, 1:].ravel()
    angle = np.zeros(count)
    reached = np.ones(count, np.bool_)
    while len(rows):
        growth = np.expm1(np.minimum(loop.rate(low, rows) * (high - low), 50.0))
        certain = loop.bound(low, rows) * growth < _CERTAIN * np.abs(at_low)
        change = np.angle(at_high[certain] / at_low[certain])
        angle += np.bincount(rows[certain], change, minlength=count)
        hopeless = ~certain & ~(high - low > _SMALLEST * high)
        crowded = np.bincount(rows[~certain], minlength=count) > _MOST_STEPS
        reached[crowded | (~np.isfinite(tail))] = False
        reached[rows[hopeless]] = False
        left = ~certain & reached[rows]
        rows, low, high = rows[left], low[left], high[left]
        at_low, at_high = at_low[left], at_high[left]
        middle = 0.5 * (low + high)
        at_middle = _return_difference(loop, middle, rows)
        rows = np.concatenate([rows, rows])
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
        at_low, at_high = (
            np.concatenate([at_low, at_middle]),
            np.concatenate([at_middle, at_high]),
        )
    return angle, reached


def _return_difference(loop: DeadTimeLoop, omega: FloatArray, rows: IntArray) -> ComplexArray:
    return np.asarray(1 + loop.response(np.asarray(1j * omega, np.complex128), rows))
