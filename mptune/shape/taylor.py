"""Functions of frequency enclosed over intervals: straight lines and what they leave.

A ``Line`` encloses an analytic f over |ω − c| ≤ r, many intervals at once ``(I,)``::

    |f(c + r·x) − value − move·x| ≤ rest        for every −1 ≤ x ≤ 1

Every operation is an inclusion in floating point: beside what follows from its operands it adds
``ROUND`` times the size of its result. One rounding is at most 1.1e-16 of a result, a complex
product at most 2.5e-16, and the library's sin and cos are taken to be right within 4 units in the
last place; ``ROUND`` = 1e-15 is above each of these.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.arrays import ComplexArray, FloatArray, IntArray

ROUND = 1e-15  # of the size of a result: what one operation in floating point may be off by
_WIDER = 1 + 1e-14  # what the roundings on the way to a radius may have taken off it


class Line(NamedTuple):
    """A complex function over intervals, ``(I,)`` each: see the module."""

    value: ComplexArray
    move: ComplexArray
    rest: FloatArray

    @property
    def largest(self) -> FloatArray:
        """An upper bound of |f| over the intervals, ``(I,)``."""
        return np.asarray((np.abs(self.value) + np.abs(self.move) + self.rest) * _WIDER)

    @property
    def smallest(self) -> FloatArray:
        """A lower bound of |f| over the intervals, ``(I,)``; below 0 where f may be 0."""
        taken = (np.abs(self.move) + self.rest) * _WIDER
        return np.asarray(np.abs(self.value) * (2 - _WIDER) - taken)

    def shifted(self, exponent: IntArray) -> Line:
        """Return f·2^exponent, exact but where it underflows, which 1e-300 covers.

        What overflows is not finite, and nothing is proved of it.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            power = np.ldexp(1.0, exponent)
            return Line(self.value * power, self.move * power, self.rest * power + 1e-300)


def plus(a: Line, b: Line) -> Line:
    """Return a + b."""
    value, move = a.value + b.value, a.move + b.move
    rounding = ROUND * (np.abs(value) + np.abs(move))
    return Line(value, move, (a.rest + b.rest + rounding) * _WIDER)


def times(a: Line, b: Line) -> Line:
    """Return a·b: the product of both moves is left over."""
    size_a, size_b = np.abs(a.value), np.abs(b.value)
    move_a, move_b = np.abs(a.move), np.abs(b.move)
    rest = (
        move_a * move_b
        + a.rest * (size_b + move_b)
        + b.rest * (size_a + move_a)
        + a.rest * b.rest
        + ROUND * (size_a * size_b + 2 * (size_a * move_b + move_a * size_b))
    )
    return Line(a.value * b.value, a.move * b.value + a.value * b.move, rest * _WIDER)


def constant(number: FloatArray) -> Line:
    """Return real constants ``(I,)``, exact."""
    still = np.zeros(number.shape)
    return Line(number.astype(np.complex128), still.astype(np.complex128), still)


def delayed(time: FloatArray, omega: FloatArray, radius: FloatArray) -> Line:
    """Return e^{−jωt} for t ``(I,)`` [s], from |e^{−jx} − 1 + jx| ≤ x²/2 or |e^{−jx} − 1| ≤ 2.

    The second, without a move, holds however far the interval turns: where little of the loop is
    left, intervals need not follow its dead time.
    """
    phase = omega * time
    value = np.cos(phase) - 1j * np.sin(phase)
    turn = time * radius
    near = turn < 2
    rounding = ROUND * (2 + 2 * np.abs(phase)) * np.where(near, 1 + turn, 1.0)
    move = np.where(near, -1j * turn * value, 0.0)
    return Line(value, move, (np.where(near, 0.5 * turn**2, 2.0) + rounding) * _WIDER)


def factors(offset: ComplexArray, omega: FloatArray, radius: FloatArray) -> tuple[Line, IntArray]:
    """Return Π_i (jω + offset_i) as a line times 2^exponent, exponents ``(I,)``.

    Parameters
    ----------
    offset
        ``(I, n)`` factors of every interval [rad/s]; NaN stands for a factor 1. The real part of a
        factor is exact and its imaginary part is rounded once, so that a pole close to the axis
        loses nothing.
    omega, radius
        ``(I,)`` centres and half widths of the intervals [rad/s].
    """
    found = constant(np.ones(omega.shape))
    exponent = np.zeros(omega.shape, np.int64)
    for column in offset.T:
        there = ~np.isnan(column)
        value = np.where(there, column + 1j * omega, 1.0)
        size = np.where(there, np.abs(column) + omega + radius, 1.0)
        power = np.frexp(size)[1].astype(np.int64)
        move = np.where(there, 1j * radius, 0.0)
        one = Line(value, move, ROUND * (np.abs(value) + np.abs(move))).shifted(-power)
        found = times(found, one)
        exponent += power
    return found, exponent


def polynomial(
    coefficients: Sequence[float], omega: FloatArray, radius: FloatArray
) -> tuple[Line, IntArray]:
    """Return Σ c_k s^k at s = jω, falling powers, as a line times 2^exponent ``(I,)``."""
    highest = np.array(coefficients, np.float64)
    reach, s = omega + radius, np.asarray(1j * omega)
    first, second = np.polyder(highest), np.polyder(highest, 2)
    size = np.polyval(np.abs(highest), reach)
    most = np.polyval(np.abs(first), reach) * radius
    rounding = 4 * len(highest) * ROUND * (size + most)
    rest = 0.5 * np.polyval(np.abs(second), reach) * radius**2 + rounding
    value, move = np.polyval(highest, s), 1j * np.polyval(first, s) * radius
    line = Line(np.asarray(value, np.complex128), move, np.asarray(rest * _WIDER))
    power = np.frexp(size)[1].astype(np.int64)
    return line.shifted(-power), power
