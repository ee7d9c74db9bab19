"""A study: one machine, its uncertainty, its controller and what is asked of them."""

from __future__ import annotations

import hashlib
import json
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Self

from pydantic import AfterValidator, Field, model_validator

from mptune.escaping import toml_key
from mptune.params.campaign import Campaign
from mptune.params.controller import Controller, Feedforward, Gains
from mptune.params.doubts import Doubt
from mptune.params.estimator import Estimator
from mptune.params.identification import Identification
from mptune.params.lines import Edges, SupplyLine, check_lines, converters_of, edge_rule
from mptune.params.machine import Cylinder, Hose, Load, Oil, SensorTruth, Valves
from mptune.params.manoeuvre import Manoeuvre, Verification
from mptune.params.requirements import Objective, Requirements
from mptune.params.section import Range, Section, refuse
from mptune.params.supplies import Supplies
from mptune.params.systems import Systems
from mptune.params.uncertainty import Model, Uncertainty, UncertaintySet
from mptune.summary import Summarised

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.params.valve_states import EdgeRule
CHOSEN = ("gains", "feedforward", "estimator")
"""Sections that a tuner may choose: they stand in gains files and outside the model's hash."""

# What the paper's machine has none of: left out of the hash where it says nothing else.
_PLAIN = {"lines": (), "edges": Edges().model_dump(), "controller.weight_pressure": 0.0}

SOURCE_KINDS = ("published", "derived", "assumed", "calibrated", "measured")
_LIKE_THIS = 'write sources like "cylinder.bore" = "derived: how"'


def interpolated(place: float, places: Sequence[float], values: Sequence[float]) -> float:
    """Return a value between rows, linearly; beyond the ends that of the nearest."""
    if place <= places[0]:
        return values[0]
    for (left, low), (right, high) in pairwise(zip(places, values, strict=True)):
        if place <= right:
            return low + (high - low) * (place - left) / (right - left)
    return values[-1]


def _of_a_section(key: str) -> str:
    if key.partition(".")[0] not in Study.model_fields:
        refuse("is a source of something that is no section of a study", _LIKE_THIS)
    return key


def _of_a_kind(source: str) -> str:
    if not source.startswith(SOURCE_KINDS):
        refuse(f"is a source that starts with none of {', '.join(SOURCE_KINDS)}", _LIKE_THIS)
    return source


class Study(Summarised, Section):
    """Everything that a study file says, in SI."""

    title: str = Field("", description="title for print")
    cylinder: Cylinder
    oil: Oil
    hose: Hose
    valves: Valves
    supplies: Supplies = Supplies()
    lines: tuple[SupplyLine, ...] = ()
    edges: Edges = Edges()
    load: Load
    sensors: SensorTruth = SensorTruth()
    controller: Controller
    estimator: Estimator = Estimator()
    uncertainty: Uncertainty
    model: Model = Model()
    gains: Gains
    feedforward: Feedforward = Feedforward()
    requirements: Requirements = Requirements()
    objective: Objective = Objective(kind="tracking")
    manoeuvre: tuple[Manoeuvre, ...] = Field(min_length=1)
    verification: Verification
    identification: Identification = Identification()
    campaign: Campaign = Campaign()
    systems: Systems = Systems()
    sources: dict[
        Annotated[str, AfterValidator(_of_a_section)], Annotated[str, AfterValidator(_of_a_kind)]
    ] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _moves_stay_within_the_stroke(self) -> Self:
        position = self.verification.start
        for index, move in enumerate(self.manoeuvre):
            for place in move.reach:
                if not 0 <= position + place <= self.cylinder.stroke:
                    refuse(
                        f"has a manoeuvre (number {index + 1}) that leaves the stroke, "
                        f"at {position + place:g} m",
                        "shorten the move or change verification.start",
                    )
            position += move.net_distance
        return self

    @model_validator(mode="after")
    def _lines_make_a_machine(self) -> Self:
        check_lines(self.lines)
        return self

    @model_validator(mode="after")
    def _no_filters_beside_an_estimator(self) -> Self:
        if self.estimator.kind == "state" and self.model.measurement_path == "filters":
            refuse(
                'has model.measurement_path = "filters" with a state estimator, around which no '
                "velocity loop separates",
                'set model.measurement_path = "none"; requirements then rest on F_ref',
            )
        return self

    @model_validator(mode="after")
    def _an_estimator_to_turn(self) -> Self:
        if "position_filter" in self.objective.turned:
            if self.estimator.kind == "state":
                refuse(
                    "has position_filter in objective.free, but a state estimator in its place",
                    'set estimator.kind = "filters", or leave it out',
                )
            if self.model.measurement_path == "filters":
                refuse(
                    "has position_filter in objective.free, and in both inequalities, whose "
                    "largest velocity gain is known for one filter only",
                    'set model.measurement_path = "none", or leave it out',
                )
        turned = [one for one in self.objective.turned if one.startswith("estimator_")]
        if turned and self.estimator.kind == "filters":
            refuse(
                f"has {turned[0]} in objective.free, but no state estimator",
                'set estimator.kind = "state", or leave it out',
            )
        return self

    @property
    def headline(self) -> str:
        """The title."""
        return f"Study {self.title}".rstrip()

    @property
    def filtering(self) -> Controller:
        """The controller with the position filter that was chosen with the gains, where one was."""
        chosen = self.estimator.position_filter
        if chosen is None:
            return self.controller
        return self.controller.model_copy(update={"position_filter": chosen})

    def reach(self) -> tuple[float, float]:
        """Return the least and the largest position of the piston on its moves [m]."""
        position = self.verification.start
        places = [position]
        for move in self.manoeuvre:
            places += [position + place for place in move.reach]
            position += move.net_distance
        return min(places), max(places)

    def loads_at(self, force: float) -> tuple[float, ...]:
        """Return the load [N] at the ends of the moves, and at the table's rows between them.

        ``force`` [N] is the constant part.
        """
        start, stiffness = self.verification.start, self.load.stiffness
        return tuple(
            force + stiffness * (place - start) + added for place, added, _ in self._table()
        )

    def inertia_factors(self) -> tuple[float, ...]:
        """Return the factor of the inertia at the same positions; 1 without a table."""
        return tuple(factor for _, _, factor in self._table())

    def _table(self) -> list[tuple[float, float, float]]:
        """Return position, added force and factor of the inertia where the moves go."""
        low, high = self.reach()
        rows = self.load.table or ((low, 0.0, 1.0), (high, 0.0, 1.0))
        columns = tuple(zip(*rows, strict=True))
        inside = [place for place in columns[0] if low < place < high]
        return [
            (place, interpolated(place, columns[0], columns[1]),
             interpolated(place, columns[0], columns[2]))
            for place in (low, *inside, high)
        ]  # fmt: skip

    @property
    def edge_rule(self) -> EdgeRule:
        """The valves of every line, and the kinds of states that they are put to."""
        return edge_rule(self.lines, self.edges)

    @property
    def converters(self) -> int:
        """K, converter cylinders; the paper's four where no lines are given."""
        return converters_of(self.lines)

    @property
    def summed_delay(self) -> Range:
        """The total delay as a sum: T_S/2, valve and computation [s] (§5.1)."""
        half, valves = self.controller.sampling_period / 2, self.valves
        pairs = zip(valves.delay, valves.computation_delay, strict=True)
        least, largest = (float(f"{half + valve + own:.12g}") for valve, own in pairs)
        return least, largest  # 14 ms as it would be written, not its neighbour

    def source_of(self, key: str) -> str:
        """Return where a value comes from: its own entry, or its section's, or nothing."""
        section = key.rsplit(".", 1)[0]
        return self.sources.get(key) or self.sources.get(section) or ""


class ResolvedStudy(Summarised, Section):
    """A study with its uncertainty set chosen, ready for work.

    Attributes
    ----------
    name
        The name of the study: its folder's.
    uncertainty_name
        The name of the chosen set; empty for the default.
    doubts
        What of the study may be meant otherwise than written.
    """

    name: str
    study: Study
    uncertainty: UncertaintySet
    uncertainty_name: str = ""
    doubts: tuple[Doubt, ...] = ()

    @property
    def headline(self) -> str:
        """Name and uncertainty set."""
        return f"Study {self.name}, uncertainty {self.uncertainty_name or 'default'}"

    def key_of(self, name: str) -> str:
        """Return the dotted key of a value of the chosen uncertainty set, as TOML has it."""
        chosen = f"sets.{toml_key(self.uncertainty_name)}." if self.uncertainty_name else ""
        return f"uncertainty.{chosen}{name}"

    @property
    def title(self) -> str:
        """The title for print."""
        return self.study.title or self.name

    def model_values(self) -> dict[str, Any]:
        """Return the SI model: all but what is chosen, what it is tried on, title and sources."""
        tried_on = {"verification", "identification", "campaign", "systems"}
        left_out = {*CHOSEN, "title", "sources", "uncertainty", *tried_on}
        values = self.study.model_dump(exclude=left_out)
        del values["controller"]["max_combinations"]  # a limit of work, no part of the model
        for name, plain in _PLAIN.items():  # so that older hashes hold
            section, _, key = name.rpartition(".")
            place = values[section] if section else values
            if place[key] == plain:
                del place[key]
        if self.study.estimator.kind != "filters":  # which is no tuner's choice
            values["estimator"] = {"kind": self.study.estimator.kind}
        unnamed = {"measured": {"__all__": {"name"}}}  # a file's content counts, not its name
        box = self.uncertainty.model_dump(exclude=unnamed)
        if self.uncertainty.explicit_delay == self.uncertainty.lumped_delay:
            del box["delay_as_it_runs"]  # one range, written once or twice
        if box["nominal"]["delay_as_it_runs"] is None:
            del box["nominal"]["delay_as_it_runs"]
        values["uncertainty"] = box
        return values

    def hash(self) -> str:
        """Return the hash of the SI model, which ties a gains file to its study."""
        text = json.dumps(self.model_values(), sort_keys=True, ensure_ascii=True)
        return hashlib.sha256(text.encode()).hexdigest()
