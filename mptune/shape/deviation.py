"""The condition of Eq. 17 and Eq. 21 for rational plants: the family's error times the nominal |T|.

With the nominal P = B/A·e^{−sd} and a member P_n = B_n/A_n·e^{−sd_n}, and poles common to both
left out of A and A_n as A' and A_n'::

    (P_n/P − 1)·T = (B_n·A'·e^{−sd_n} − B·A_n'·e^{−sd})·N / (A_n'·χ)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.shape.rational_loops import RationalLoops, over, padded
from mptune.shape.taylor import Line, factors, plus, times

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.arrays import ComplexArray, FloatArray, IntArray
    from mptune.shape.rational import RationalPlant


class Deviation:
    """max over ω of |P_n/P − 1|·|T| for N members of a family about one nominal plant.

    Parameters
    ----------
    nominal, members
        The plants.
    numerator, denominator
        The controller, falling powers of s.
    """

    def __init__(
        self,
        nominal: RationalPlant,
        members: Sequence[RationalPlant],
        numerator: Sequence[float],
        denominator: Sequence[float],
    ) -> None:
        self._nominal = RationalLoops([nominal] * len(members), numerator, denominator)
        self._members = RationalLoops(members, numerator, denominator)
        pairs = [_without_common(nominal.poles, one.poles) for one in members]
        self._own = padded([pair[0] for pair in pairs])  # A'
        self._other = padded([pair[1] for pair in pairs])  # A_n'

    def __len__(self) -> int:
        """Return N."""
        return len(self._members)

    @property
    def edges(self) -> list[FloatArray]:
        """Frequencies to begin the subdivision of each function with, N arrays [rad/s]."""
        pairs = zip(self._nominal.edges, self._members.edges, strict=True)
        return [np.union1d(one, other) for one, other in pairs]

    def lines(self, rows: IntArray, omega: FloatArray, radius: FloatArray) -> tuple[Line, Line]:
        """Return numerator and denominator over intervals, each of one row."""
        own, power_own = factors(-self._own[rows], omega, radius)
        other, power_other = factors(-self._other[rows], omega, radius)
        here, power_here = self._nominal.forward(rows, omega, radius)
        there, power_there = self._members.forward(rows, omega, radius)
        left = times(there, own).shifted(power_there + power_own - power_other)
        right = times(here, other).shifted(power_here)
        error = plus(left, Line(-right.value, -right.move, right.rest))
        parts = self._nominal.parts(rows, omega, radius)
        return times(error, parts.numerator), times(other, parts.characteristic)

    def beyond(self, omega: FloatArray) -> FloatArray:
        """Return a bound of each function beyond ω ``(N,)``: |L_n − L| over |1 + L|."""
        nominal, member = self._nominal.tail(omega), self._members.tail(omega)
        return over((nominal.gain + member.gain) * (1 + 1e-12), nominal.distance)


def _without_common(
    one: Sequence[complex] | ComplexArray, other: Sequence[complex] | ComplexArray
) -> tuple[list[complex], list[complex]]:
    """Return two lists of roots without those that both hold, as often as both hold them."""
    left, right = list(one), list(other)
    for root in one:
        if root in right:
            left.remove(root)
            right.remove(root)
    return left, right
