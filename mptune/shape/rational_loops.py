"""Loops of rational plants with dead time under one rational controller, as pairs without a pole.

With P = B/A·e^{−sd} and C = N/D, polynomials all, every closed-loop function is a quotient of
two functions that are analytic everywhere::

    S = A·D / χ        T = B·N·e^{−sd} / χ        C·S = A·N / χ        χ = A·D + B·N·e^{−sd}

No pole of the open loop is a pole of these, at the origin or on the axis: ω = 0 is a frequency
like any other, and the zeros of χ are the closed loop's poles, hidden ones included.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from mptune.shape.problem import Function
from mptune.shape.rational import landmarks
from mptune.shape.taylor import Line, constant, delayed, factors, plus, polynomial, times

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.arrays import ComplexArray, FloatArray, IntArray
    from mptune.shape.rational import RationalPlant

_WIDER = 1 + 1e-12  # what roundings may have taken off a bound of the tail


class Tail(NamedTuple):
    """|L(s) − centre| ≤ radius and |C(s)| ≤ control wherever Re s ≥ 0 and |s| ≥ ω, ``(N,)``."""

    centre: FloatArray
    radius: FloatArray
    control: FloatArray

    @property
    def gain(self) -> FloatArray:
        """An upper bound of |L|, ``(N,)``."""
        return np.asarray(np.abs(self.centre) + self.radius)

    @property
    def distance(self) -> FloatArray:
        """A lower bound of |1 + L|, ``(N,)``; not above 0 where none is known."""
        return np.asarray(np.abs(1 + self.centre) - self.radius)


class Parts(NamedTuple):
    """The functions of the module's head over intervals, over one common positive factor."""

    open_loop: Line  # A·D
    through: Line  # B·N·e^{−sd}
    control: Line  # A·N
    characteristic: Line  # χ
    numerator: Line  # N


class Quotients(Protocol):
    """N closed-loop functions as quotients of two analytic functions of frequency."""

    @property
    def edges(self) -> list[FloatArray]:
        """Frequencies to begin the subdivision of each function with, N arrays [rad/s]."""
        ...

    def __len__(self) -> int:
        """Return N."""
        ...

    def lines(self, rows: IntArray, omega: FloatArray, radius: FloatArray) -> tuple[Line, Line]:
        """Return numerator and denominator over intervals, each of one row."""
        ...

    def beyond(self, omega: FloatArray) -> FloatArray:
        """Return a bound of each function beyond ω ``(N,)``; infinite where none is known."""
        ...


class RationalLoops:
    """N loops: plants of any degree each, and a controller C = numerator/denominator.

    Parameters
    ----------
    plants
        The plants.
    numerator, denominator
        The controller, falling powers of s; powers of s common to both are left out.
    """

    def __init__(
        self,
        plants: Sequence[RationalPlant],
        numerator: Sequence[float],
        denominator: Sequence[float],
    ) -> None:
        self._numerator, self._denominator = _without_common_s(numerator, denominator)
        self._zeros = padded([plant.zeros for plant in plants])
        self._poles = padded([plant.poles for plant in plants])
        self._gain = np.array([plant.gain for plant in plants])
        self._delay = np.array([plant.delay for plant in plants])
        counts = [len(plant.poles) - len(plant.zeros) for plant in plants]
        self._excess = np.array(counts) + len(self._denominator) - len(self._numerator)
        shared = landmarks([*np.roots(self._denominator), *np.roots(self._numerator)])
        self.edges = [np.union1d(plant.landmarks, shared) for plant in plants]

    def __len__(self) -> int:
        """Return N."""
        return len(self._gain)

    def parts(self, rows: IntArray, omega: FloatArray, radius: FloatArray) -> Parts:
        """Return what closed-loop functions are made of.

        Parameters
        ----------
        rows, omega, radius
            ``(I,)`` the loop of each interval, its centre and half width [rad/s].
        """
        a, power_a = factors(-self._poles[rows], omega, radius)
        n, power_n = polynomial(self._numerator, omega, radius)
        d, power_d = polynomial(self._denominator, omega, radius)
        b, power_b = self.forward(rows, omega, radius)
        common = np.maximum(power_a + power_d, power_b + power_n)
        open_loop = times(a, d).shifted(power_a + power_d - common)
        through = times(b, n).shifted(power_b + power_n - common)
        return Parts(
            open_loop,
            through,
            times(a, n).shifted(power_a + power_n - common),
            plus(open_loop, through),
            n.shifted(power_n - common),
        )

    def forward(
        self, rows: IntArray, omega: FloatArray, radius: FloatArray
    ) -> tuple[Line, IntArray]:
        """Return B·e^{−sd}, gain included, as a line times 2^exponent."""
        b, power = factors(-self._zeros[rows], omega, radius)
        turn = delayed(self._delay[rows], omega, radius)
        return times(times(b, constant(self._gain[rows])), turn), power

    def turned(self, omega: FloatArray) -> FloatArray:
        """Return the argument of A·D at ω ``(N,)``, gathered root by root so that π/2 is its end.

        Above every open-loop pole the argument of jω − pole lies between 0 and π.
        """
        own = np.nansum(np.angle(1j * omega[:, None] - self._poles), axis=1)
        shared = np.angle(1j * omega[:, None] - np.roots(self._denominator)).sum(axis=1)
        return np.asarray(own + shared)

    @property
    def reach(self) -> FloatArray:
        """``(N,)``: the size of the largest open-loop pole of each [rad/s]; 1 where all are 0."""
        shared = np.abs(np.roots(self._denominator)).max(initial=0.0)
        largest = np.maximum(_sizes(self._poles).max(axis=1, initial=0.0), shared)
        return np.where(largest > 0, largest, 1.0)

    def tail(self, omega: FloatArray) -> Tail:
        """Return what is certain beyond ω ``(N,)`` [rad/s], above every open-loop pole.

        Each factor over its power of s only falls towards 1 there, and |e^{−sd}| ≤ 1. A proper loop
        without dead time tends to a constant, the centre; else that is 0.
        """
        with np.errstate(divide="ignore"):
            above = np.log1p(_sizes(self._zeros) / omega[:, None]).sum(axis=1)
            below = np.log1p(-np.minimum(_sizes(self._poles) / omega[:, None], 1)).sum(axis=1)
            up, down = _spread(self._numerator, omega)[1], _spread(self._denominator, omega)[0]
            controller = abs(self._numerator[0] / self._denominator[0]) * over(up, down)
            proper = len(self._denominator) - len(self._numerator)
            size = np.exp(above - below) * np.abs(self._gain) * controller * _WIDER
            size = size * omega ** (-self._excess.astype(np.float64))
            control = controller * omega ** (-float(proper)) * _WIDER
        size = np.where(self._excess >= 0, size, np.inf)
        still = (self._excess == 0) & (self._delay == 0)
        centre = np.where(still, self._gain * self._numerator[0] / self._denominator[0], 0.0)
        radius = (size - np.abs(centre)) + 1e-12 * np.where(still, np.abs(centre), 0.0)
        return Tail(centre, radius, control if proper >= 0 else np.full(len(self), np.inf))


@dataclass(frozen=True)
class ClosedLoop:
    """|S|, |T| or |CS| of loops."""

    loops: RationalLoops
    function: Function

    @property
    def edges(self) -> list[FloatArray]:
        """Frequencies to begin the subdivision of each function with, N arrays [rad/s]."""
        return self.loops.edges

    def __len__(self) -> int:
        """Return N."""
        return len(self.loops)

    def lines(self, rows: IntArray, omega: FloatArray, radius: FloatArray) -> tuple[Line, Line]:
        """Return numerator and denominator over intervals, each of one row."""
        parts = self.loops.parts(rows, omega, radius)
        upper = {
            Function.SENSITIVITY: parts.open_loop,
            Function.COMPLEMENTARY: parts.through,
            Function.CONTROL: parts.control,
        }[self.function]
        return upper, parts.characteristic

    def beyond(self, omega: FloatArray) -> FloatArray:
        """Return a bound of each function beyond ω ``(N,)``; infinite where none is known."""
        tail = self.loops.tail(omega)
        upper = {
            Function.SENSITIVITY: np.ones(len(self)),
            Function.COMPLEMENTARY: tail.gain,
            Function.CONTROL: tail.control,
        }[self.function]
        return over(upper * _WIDER, tail.distance)


def _without_common_s(
    numerator: Sequence[float], denominator: Sequence[float]
) -> tuple[list[float], list[float]]:
    """Return a fraction without powers of s common to both parts, and without leading zeros."""
    upper = np.trim_zeros(np.asarray(numerator, np.float64), "f").tolist()
    lower = np.trim_zeros(np.asarray(denominator, np.float64), "f").tolist()
    if not upper:
        return [0.0], [1.0]
    while upper[-1] == 0 and lower[-1] == 0:
        upper, lower = upper[:-1], lower[:-1]
    return upper, lower


def _spread(coefficients: Sequence[float], omega: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return least and largest |p(s)|/(|lead|·|s|^k) for |s| ≥ ω."""
    lead = abs(coefficients[0]) or 1.0
    others = [0.0, *(abs(one) / lead for one in coefficients[1:])]
    rest = np.asarray(np.polyval(others[::-1], 1 / omega), np.float64)
    return 1 - rest, 1 + rest


def _sizes(roots: ComplexArray) -> FloatArray:
    """Return |root|, 0 where there is none."""
    return np.asarray(np.nan_to_num(np.abs(roots), nan=0.0))


def over(upper: FloatArray, lower: FloatArray) -> FloatArray:
    """Return upper/lower, infinite where lower is not above 0."""
    found = np.full(upper.shape, np.inf)
    np.divide(upper, lower, out=found, where=lower > 0)
    return found


def padded(roots: Sequence[Sequence[complex] | ComplexArray]) -> ComplexArray:
    """Return the roots of several plants as one table, NaN where a plant has fewer."""
    table = np.full((len(roots), max(len(one) for one in roots)), np.nan, np.complex128)
    for row, one in enumerate(roots):
        table[row, : len(one)] = one
    return table
