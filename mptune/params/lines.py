"""The lines between which a machine's chambers are switched, and the valves that switch them.

``[supplies]`` alone is the paper's machine: a tank line, an accumulator, and four converters at
even shares between the two. ``[[lines]]`` says any other, lowest pressure first; ``[supplies]``
then holds what its accumulator and its converters are, where it has any.
"""

from __future__ import annotations

import math
from enum import StrEnum
from itertools import pairwise
from typing import TYPE_CHECKING, Self

from pydantic import Field, StrictInt, model_validator

from mptune.params.section import Section, quantity, refuse
from mptune.params.valve_states import EdgeRule, StateKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.params.supplies import Supplies

_FEWEST_LINES = 2


class LineKind(StrEnum):
    """What makes a line's pressure."""

    TANK = "tank"  # the lowest line: what flows into it is lost
    CONSTANT = "constant"
    CONVERTER = "converter"  # a converter cylinder between two other lines
    PUMP = "pump"  # the highest line: a margin above the load, one way
    ACCUMULATOR = "accumulator"  # the highest line, with a pump that is switched


class SupplyLine(Section):
    """One line of constant pressure, or of what makes its pressure."""

    kind: LineKind = Field(description="what makes the pressure")
    pressure: float | None = quantity(
        "Pa", "p", "pressure; nominal, of an accumulator; largest, of a pump", None,
        at_least=0, at_most=1e9,
    )  # fmt: skip
    between: tuple[StrictInt, StrictInt] | None = Field(
        None, description="numbers of the two lines, the lowest is 1, between which a converter is"
    )
    share: float | None = quantity(
        "1",
        "α",
        "how much of a converter's oil the upper of them gives",
        None,
        above=0,
        at_most=0.99,
    )
    sizes: tuple[float, ...] = quantity(
        "1", "n", "its valves' sizes, in valves.flow_coefficient; edges.sizes", (),
        at_least=1e-3, at_most=1e3,
    )  # fmt: skip
    margin: float | None = quantity(
        "Pa", "p_m", "of a pump: pressure above the load", None, at_least=0, at_most=1e8
    )
    standby: float | None = quantity(
        "Pa", "p_s", "of a pump: least pressure", None, at_least=0, at_most=1e9
    )
    lag: float | None = quantity(
        "s", "τ_p", "of a pump: lag of its pressure", None, at_least=1e-3, at_most=10
    )

    @model_validator(mode="after")
    def _has_what_its_kind_needs(self) -> Self:
        needed = {
            LineKind.CONVERTER: {"between", "share"},
            LineKind.PUMP: {"pressure", "margin", "standby", "lag"},
        }.get(self.kind, {"pressure"})
        for name in ("pressure", "between", "share", "margin", "standby", "lag"):
            given = getattr(self, name) is not None
            if given != (name in needed):
                verb, remedy = ("no", "add it") if name in needed else ("a", "leave it out")
                refuse(f"is a line of kind {self.kind.value!r} with {verb} {name}", remedy)
        return self


class Edges(Section):
    """The valves in parallel between each line and each chamber, and the states they are put to."""

    sizes: tuple[float, ...] = quantity(
        "1", "n", "sizes of the parallel valves, in valves.flow_coefficient", (1.0, 1.0),
        at_least=1e-3, at_most=1e3,
    )  # fmt: skip
    states: tuple[StateKind, ...] = Field(
        (StateKind.ALL, StateKind.SINGLE, StateKind.CROSSFLOW),
        min_length=1,
        description="kinds of valve states beside the closed one",
    )


PAPER_LINES = 6
_OF_CONVERTERS = ("converter_area", "converter_friction", "converter_travel")
# Why a kind can only be the last line, and what else may be done about it.
_ONLY_LAST = {
    LineKind.ACCUMULATOR: (
        "the machine has one volume of gas, and between the two ends no pressure is measured",
        "make it constant, as a large accumulator nearly is, or ",
    ),
    LineKind.PUMP: ("it keeps its margin above the load at the highest line", ""),
}


def edge_rule(lines: Sequence[SupplyLine], edges: Edges) -> EdgeRule:
    """Return the valves of every line; of the paper's six where there are none."""
    own = [line.sizes for line in lines] or [()] * PAPER_LINES
    return EdgeRule(tuple(sizes or edges.sizes for sizes in own), edges.states)


def converters_of(lines: Sequence[SupplyLine]) -> int:
    """Return the number of converter cylinders; the paper's where there are no lines."""
    if not lines:
        return PAPER_LINES - 2
    return sum(line.kind is LineKind.CONVERTER for line in lines)


def check_lines(lines: Sequence[SupplyLine]) -> None:
    """Refuse lines that make no machine.

    Raises
    ------
    PydanticCustomError
        Naming the number of the line and the rule.
    """
    if not lines:
        return
    if len(lines) < _FEWEST_LINES:
        refuse("has a single line", "a piston needs two pressures: add a line")
    last = len(lines)
    for number, line in enumerate(lines, 1):
        if (line.kind is LineKind.TANK) != (number == 1):
            refuse(
                f"has line {number} of kind {line.kind.value!r}",
                "the first line, it alone, is a tank",
            )
        if line.kind in _ONLY_LAST and number != last:
            why, remedy = _ONLY_LAST[line.kind]
            refuse(
                f"has line {number} of kind {line.kind.value!r}, which only the last may be: {why}",
                f"{remedy}order the lines by rising pressure",
            )
        if line.kind is LineKind.CONVERTER and lines[-1].kind is LineKind.PUMP:
            refuse("has a converter below a pump", "let an accumulator take its oil back")
        if line.kind is LineKind.CONVERTER:
            _check_converter(number, line, lines)
    for number, (below, above) in enumerate(pairwise(nominal_pressures(lines)), 1):
        if above <= below:
            refuse(
                f"has line {number + 1} at {above / 1e6:g} MPa, not above line {number} at "
                f"{below / 1e6:g} MPa",
                "order the lines by rising pressure",
            )


def _check_converter(number: int, line: SupplyLine, lines: Sequence[SupplyLine]) -> None:
    low, high = line.between or (0, 0)
    if number == len(lines):
        refuse("has a converter as its last line", "end with the line of the highest pressure")
    if not 1 <= low < number < high <= len(lines):
        refuse(f"has line {number} between {low} and {high}", "name a line below and one above it")
    if LineKind.CONVERTER in {lines[low - 1].kind, lines[high - 1].kind}:
        refuse(f"has line {number} between lines of which one is a converter", "name others")


def nominal_pressures(lines: Sequence[SupplyLine]) -> tuple[float, ...]:
    """Return the nominal pressure of every line [Pa]."""
    found = [math.nan if line.pressure is None else line.pressure for line in lines]
    for number, line in enumerate(lines):
        if line.between is not None and line.share is not None:
            low, high = (found[one - 1] for one in line.between)
            found[number] = low + line.share * (high - low)
    return tuple(found)


def supplies_of(lines: Sequence[SupplyLine], supplies: Supplies) -> Supplies:
    """Return ``[supplies]`` with what the lines say: their ends, and what there is none of.

    Without an accumulator its volume is 0 and the highest line keeps its pressure. What is met
    nowhere then, like the end of a converter's travel, is infinite.
    """
    return supplies.model_copy(update=instead_of_supplies(lines)) if lines else supplies


def instead_of_supplies(lines: Sequence[SupplyLine]) -> dict[str, float]:
    """Return what lines say instead of ``[supplies]``, see ``supplies_of``."""
    if not lines:
        return {}
    pressures = nominal_pressures(lines)
    high = pressures[-1]
    found = {"low_pressure": pressures[0], "high_pressure": high}
    if lines[-1].kind is not LineKind.ACCUMULATOR:
        found |= dict.fromkeys(("pump_on", "pump_off", "relief_pressure"), high)
        found |= dict.fromkeys(("pump_flow", "accumulator_exponent"), math.inf)
        found |= {"accumulator_volume": 0.0, "accumulator_precharge": 0.0}
    if not any(line.kind is LineKind.CONVERTER for line in lines):
        found |= dict.fromkeys(_OF_CONVERTERS, math.inf)
    return found


def missing_supplies(supplies: Supplies) -> tuple[str, ...]:
    """Return the dotted keys of ``[supplies]`` that are asked for and not given."""
    names = [name for name in type(supplies).model_fields if math.isnan(getattr(supplies, name))]
    if len(names) == len(type(supplies).model_fields):
        return ("supplies",)
    return tuple(f"supplies.{name}" for name in names)
