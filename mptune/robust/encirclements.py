"""Encirclements of −1, counted for the nominal plant, the family and its worst plant.

No plant of Eq. 14 and Eq. 15 has an open-loop pole right of the imaginary axis, with or without
the measurement path: the clockwise encirclements of −1 are the unstable closed-loop poles.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mptune.loops.broken import FORCE, VELOCITY
from mptune.loops.stability import count_unstable_poles

if TYPE_CHECKING:
    from mptune.robust.result import SweepResult


@dataclass(frozen=True)
class Encirclements:
    """Unstable closed-loop poles of one loop, with or without the measurement path.

    Attributes
    ----------
    loop
        ``VELOCITY`` or ``FORCE``.
    path
        ``"none"``, ``"filters"`` or ``"estimator"``.
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
    paths = result.model.paths
    return tuple(
        _counted(result, loop, path)
        for loop in (VELOCITY, FORCE)
        for path in paths
        if loop == FORCE or path != "estimator"  # no velocity loop separates from it
    )


def _counted(result: SweepResult, loop: int, name: str) -> Encirclements:
    model = result.model
    where = (result.gains, model.path_of(name))
    nominal = model.nominal_loop(*where, which=loop)
    family = count_unstable_poles(model.loops(*where, which=loop))
    at = (result.velocity if loop == VELOCITY else result.position).at
    worst = None
    if at.response is None:
        plant = model.plant(at, as_it_runs=name != "none")
        one = model.loops(*where, plants=plant, which=loop)
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
