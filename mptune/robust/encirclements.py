"""Encirclements of −1, counted for the nominal plant, the family and its worst plant.

No plant of Eq. 14 and Eq. 15 has an open-loop pole right of the imaginary axis, with or without
the measurement path: the clockwise encirclements of −1 are the unstable closed-loop poles.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mptune.loops.broken import FORCE, VELOCITY
from mptune.loops.family import FamilyLoops, nominal_plants
from mptune.loops.stability import count_unstable_poles
from mptune.params.pack import (
    NO_PATH,
    MeasurementPath,
    Plants,
    pack_filters,
    pack_gains,
    pack_nominal,
)

if TYPE_CHECKING:
    from mptune.robust.place import PlantPoint
    from mptune.robust.result import SweepResult


@dataclass(frozen=True)
class Encirclements:
    """Unstable closed-loop poles of one loop, with or without the measurement path.

    Attributes
    ----------
    loop
        ``VELOCITY`` or ``FORCE``.
    path
        ``"none"`` or ``"filters"``.
    nominal, worst
        Poles with the nominal plant, and with the plant that is worst in the loop's condition;
        None where that is a measured member.
    most
        The most poles that any of the box's plants has.
    unstable_plants, undecided_plants, plants
        Plants with any such pole, plants that could not be decided, and all.
    """

    loop: int
    path: str
    nominal: int
    worst: int | None
    most: int
    unstable_plants: int
    undecided_plants: int
    plants: int


def encirclements(result: SweepResult) -> tuple[Encirclements, ...]:
    """Return the counts of the velocity loop and of the loop at F_ref, without and with the path.

    The velocity loop's worst plant is Eq. 17's, the loop's at F_ref Eq. 21's.
    """
    paths = {"none": NO_PATH, "filters": pack_filters(result.study.study.controller)}
    return tuple(
        _counted(result, loop, name, path)
        for loop in (VELOCITY, FORCE)
        for name, path in paths.items()
    )


def single(at: PlantPoint) -> Plants:
    """Return one plant as a family of one."""
    return Plants(*(np.array([x]) for x in (at.mass_kg, at.delay_s, at.tau_a_s, at.tau_b_s)))


def _counted(result: SweepResult, loop: int, name: str, path: MeasurementPath) -> Encirclements:
    gains, share_a = pack_gains(result.gains), result.study.study.cylinder.share_a
    nominal = FamilyLoops(loop, nominal_plants(pack_nominal(result.study)), 0.5, gains, path)
    family = count_unstable_poles(FamilyLoops(loop, result.plants, share_a, gains, path))
    at = (result.velocity if loop == VELOCITY else result.position).at
    worst = None
    if at.response is None:
        one = FamilyLoops(loop, single(at), share_a, gains, path)
        worst = int(count_unstable_poles(one).unstable[0])
    return Encirclements(
        loop=loop,
        path=name,
        nominal=int(count_unstable_poles(nominal).unstable[0]),
        worst=worst,
        most=int(family.unstable.max()),
        unstable_plants=int((family.unstable > 0).sum()),
        undecided_plants=int((~family.decided).sum()),
        plants=len(family.unstable),
    )
