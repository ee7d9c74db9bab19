"""The chambers that push and pull the piston.

``[cylinder]`` with bore and rod is the paper's machine: the piston side pushes, the rod side
pulls. ``[[chambers]]`` says any two or four: the first pushes, the second pulls, and with them
every further one of either side. To the outer loops both sides are a chamber each, see
``mptune.loops.family``.
"""

from __future__ import annotations

import math
from enum import StrEnum
from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic import Field

from mptune.params.section import Section, quantity, refuse

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from mptune.params.machine import Cylinder, Hose

NUMBERS = (2, 4)  # of chambers that a machine may have
LETTERS = "ABCD"
SHORT_FORM = {
    "cylinder": ("bore", "rod", "dead_volume_a", "dead_volume_b"),
    "hose": ("length_a", "length_b"),
}


class Side(StrEnum):
    """Where pressure drives the piston."""

    PUSHING = "pushing"  # outwards, to larger positions
    PULLING = "pulling"


class Chamber(Section):
    """One chamber with its hose, and how large the valves are that serve it."""

    side: Side = Field(description="whether its pressure pushes the piston out or pulls it in")
    area: float = quantity("m^2", "A_i", "piston area", at_least=1e-7, at_most=20)
    dead_volume: float = quantity("m^3", "V_0,i", "dead volume", at_least=0, at_most=10)
    hose_length: float = quantity("m", "L_h,i", "length of its hose", 0.0, at_least=0, at_most=1e3)
    valves: float = quantity(
        "1", "n_i", "size of its valves, in those of the edges", 1.0, at_least=1e-3, at_most=1e3
    )


def chambers_of(
    written: tuple[Chamber, ...], cylinder: Cylinder, hose: Hose
) -> tuple[Chamber, ...]:
    """Return the chambers as written, or the two of ``[cylinder]`` where there are none."""
    if written:
        return written
    pairs = (
        (Side.PUSHING, cylinder.area_a, cylinder.dead_volume_a, hose.length_a),
        (Side.PULLING, cylinder.area_b, cylinder.dead_volume_b, hose.length_b),
    )
    return tuple(
        Chamber.model_construct(
            side=side, area=area, dead_volume=dead, hose_length=length, valves=1.0
        )
        for side, area, dead, length in pairs
    )


def common_size(chambers: Sequence[Chamber]) -> float:
    """Return the size of the valves that all chambers have, in those of the edges.

    Of two chambers it is a part of the machine's K_v; of more each one's size is its own.
    """
    return chambers[0].valves if len(chambers) == NUMBERS[0] else 1.0


class Volumes(NamedTuple):
    """Sums over some chambers, as ``mptune.params.packed.Machine`` has them of one side."""

    area: float  # m²
    dead: float  # m³, hoses included
    hose: float  # m³
    length: float  # m, of the hoses


def volumes_of(chambers: Sequence[Chamber], hose: Hose) -> Volumes:
    """Return the sums over some chambers."""
    volumes = [hose.volume(one.hose_length) for one in chambers]
    return Volumes(
        sum(one.area for one in chambers),
        sum(one.dead_volume + volume for one, volume in zip(chambers, volumes, strict=True)),
        sum(volumes),
        sum(one.hose_length for one in chambers),
    )


def check_chambers(chambers: Sequence[Chamber]) -> None:
    """Refuse chambers that make no machine.

    Raises
    ------
    PydanticCustomError
        Naming the number of the chamber and the rule.
    """
    if not chambers:
        return
    if len(chambers) not in NUMBERS:
        refuse(
            f"has {len(chambers)} chambers, where two or four are simulated",
            "leave some out, or join those of one side that share their valves",
        )
    for number, (chamber, side) in enumerate(zip(chambers, Side, strict=False), 1):
        if chamber.side is not side:
            refuse(
                f"has chamber {number} {chamber.side}, where it is to be {side}",
                "order them: the first pushes, the second pulls",
            )
    if len(chambers) == NUMBERS[0] and chambers[0].valves != chambers[1].valves:
        refuse(
            "has two chambers with valves of different sizes",
            "give both the same, or size each line's valves by lines.sizes",
        )


def plain_sections(
    chambers: tuple[Chamber, ...], cylinder: Cylinder, hose: Hose
) -> dict[str, Section]:
    """Return ``[cylinder]`` and ``[hose]`` without what ``[[chambers]]`` says instead of them."""
    if not chambers:
        return {}
    return {
        name: section.model_copy(update=dict.fromkeys(SHORT_FORM[name], math.nan))
        for name, section in (("cylinder", cylinder), ("hose", hose))
    }


def missing_of_the_short_form(values: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the dotted keys that a study's values need without ``[[chambers]]`` and have not."""
    if values.get("chambers"):
        return ()
    sections = {name: values.get(name) for name in SHORT_FORM}
    return tuple(
        f"{name}.{key}"
        for name, section in sections.items()
        if isinstance(section, dict)
        for key in SHORT_FORM[name]
        if key not in section
    )
