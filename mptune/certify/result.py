"""What was certified: frozen, with the bound, the plant and frequency, and how it ended."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mptune.certify.problem import Point


class Grounds(StrEnum):
    """What a figure rests on."""

    CERTIFIED = "certified"  # every plant of the question and every frequency, proved
    GRID = "grid only"  # the plants and frequencies that were asked
    OPEN = "open"  # the proof was not finished within its budget, or lies across the limit


class Stability(StrEnum):
    """What is known of the closed loops of all plants of a box."""

    STABLE = "stable"  # all of them, proved
    UNSTABLE = "unstable"  # one at least: the witness
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class Bound:
    """One figure over a box: attained and guaranteed.

    Attributes
    ----------
    loop
        ``"velocity"``, ``"position"`` or ``"force_reference"``.
    path
        ``"none"``, ``"filters"`` or ``"sampled"``.
    figure
        ``"equation_17"``, ``"equation_21"``, ``"sensitivity_peak"``, ``"complementary_peak"`` or
        ``"disk_margin"``; the last is smallest where the others are largest.
    attained
        The worst value found, at the end of a local ascent; infinite (a disk margin of 0) where
        the box holds an unstable plant.
    at
        Where; None where no single frequency or plant attains it.
    bound
        What no plant of the box exceeds at any frequency (or falls below, for the disk margin).
    closed
        Whether attained and guaranteed value lie within the tolerance that was asked for. Where
        they do not, both still hold.
    boxes
        Boxes that the proof took.
    """

    loop: str
    path: str
    figure: str
    attained: float
    at: Point | None
    bound: float
    closed: bool
    boxes: int

    @property
    def gap(self) -> float:
        """How far apart both values are, relative to the attained one."""
        if self.attained == self.bound:
            return 0.0
        if not math.isfinite(self.bound) or self.attained == 0:
            return math.inf
        return abs(self.bound / self.attained - 1)


@dataclass(frozen=True)
class BoxStability:
    """Stability of all plants of a box.

    Attributes
    ----------
    loop, path
        The loop that was asked about: ``"velocity"`` alone, or the whole.
    status
        What is known.
    witness
        An unstable plant; None but with UNSTABLE.
    suspect
        Where the proof got stuck; None but with UNDECIDED.
    boxes
        Boxes that the proof took.
    """

    loop: str
    path: str
    status: Stability
    witness: Point | None
    suspect: Point | None
    boxes: int


@dataclass(frozen=True)
class Bracket:
    """A number known to lie between two.

    Attributes
    ----------
    lower
        Proved: everything below it is safe.
    upper
        Attained: at it something fails. Infinite where nothing failed as far as was looked.
    at
        What fails there.
    closed
        Whether both lie within the tolerance that was asked for.
    boxes
        Boxes that the proofs took.
    """

    lower: float
    upper: float
    at: Point | None
    closed: bool
    boxes: int

    @property
    def unproved(self) -> bool:
        """Whether no proof was finished: nothing is known to be safe, or to fail."""
        return self.lower == 0 and not self.closed
