"""A study: one machine, its uncertainty, its controller and what is asked of them."""

from __future__ import annotations

import hashlib
import json
from typing import Any, Self

from pydantic import Field, model_validator

from mptune.params.campaign import Campaign
from mptune.params.controller import Controller, Feedforward, Gains
from mptune.params.identification import Identification
from mptune.params.machine import Cylinder, Hose, Load, Oil, Supplies, Valves
from mptune.params.manoeuvre import Manoeuvre, Verification
from mptune.params.requirements import Objective, Requirements
from mptune.params.section import Section, refuse
from mptune.params.uncertainty import Model, Uncertainty, UncertaintySet
from mptune.summary import Summarised

SOURCE_KINDS = ("published", "derived", "assumed", "measured")


class Study(Summarised, Section):
    """Everything that a study file says, in SI."""

    title: str = Field("", description="title for print")
    cylinder: Cylinder
    oil: Oil
    hose: Hose
    valves: Valves
    supplies: Supplies
    load: Load
    controller: Controller
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
    sources: dict[str, str] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _sources_point_at_values(self) -> Self:
        known = set(self.model_dump())
        for key, source in self.sources.items():
            if key.split(".")[0] not in known or not source.startswith(SOURCE_KINDS):
                refuse(
                    f"has a source for `{key}` that names no section or starts with none of "
                    f"{', '.join(SOURCE_KINDS)}",
                    'write it like "cylinder.bore" = "derived: how"',
                )
        return self

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

    @property
    def headline(self) -> str:
        """The title."""
        return f"Study {self.title}".rstrip()

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
    """

    name: str
    study: Study
    uncertainty: UncertaintySet
    uncertainty_name: str = ""

    @property
    def headline(self) -> str:
        """Name and uncertainty set."""
        return f"Study {self.name}, uncertainty {self.uncertainty_name or 'default'}"

    @property
    def title(self) -> str:
        """The title for print."""
        return self.study.title or self.name

    def model_values(self) -> dict[str, Any]:
        """Return the SI model: all but gains, what they are tried on, title and sources."""
        tried_on = {"verification", "identification", "campaign"}
        left_out = {"gains", "title", "sources", "uncertainty", *tried_on}
        values = self.study.model_dump(exclude=left_out)
        unnamed = {"measured": {"__all__": {"name"}}}  # a file's content counts, not its name
        values["uncertainty"] = self.uncertainty.model_dump(exclude=unnamed)
        return values

    def hash(self) -> str:
        """Return the hash of the SI model, which ties a gains file to its study."""
        text = json.dumps(self.model_values(), sort_keys=True, ensure_ascii=True)
        return hashlib.sha256(text.encode()).hexdigest()
