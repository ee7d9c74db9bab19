"""The ranges in which the machine varies, and the nominal machine (§3.1, §5.1)."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator

from mptune.params.measured import MeasuredResponse
from mptune.params.section import Range, Section, quantity, refuse

Derived = Literal["derived"]


class Nominal(Section):
    """The nominal machine of Eq. 14; the least mass and the least delay where nothing is given."""

    mass: float | None = quantity("kg", "m_min", "nominal mass", None, at_least=10, at_most=1e7)
    delay: float | None = quantity("s", "d_min", "nominal delay", None, at_least=1e-6, at_most=1)


class UncertaintySet(Section):
    """A box of mass, total delay and pressure time constants."""

    mass: Range = quantity("kg", "m", "effective inertia", at_least=10, at_most=1e7)
    delay: Range = quantity(
        "s",
        "d",
        "total delay: half a sampling period, valve, computation",
        at_least=1e-6,
        at_most=1,
    )
    tau_a: Range | Derived = quantity(
        "s", "τ_A", "A-side time constant, or derived", words=("derived",), at_least=0, at_most=1
    )
    tau_b: Range | Derived = quantity(
        "s", "τ_B", "B-side time constant, or derived", words=("derived",), at_least=0, at_most=1
    )
    points: int = quantity("1", "n", "points per parameter", 7, at_least=1, at_most=51)
    nominal: Nominal = Nominal()
    measured: tuple[MeasuredResponse, ...] = Field(
        (), description="files of measured force responses, members of the true family"
    )
    measured_place: Literal["beside", "instead"] = Field(
        "beside", description="measured responses beside the box's plants, or instead within band"
    )

    @model_validator(mode="after")
    def _box_has_inside(self) -> Self:
        pairs = {"mass": self.mass, "delay": self.delay, "tau_a": self.tau_a, "tau_b": self.tau_b}
        for name, pair in pairs.items():
            if self.points == 1 and not isinstance(pair, str) and pair[0] != pair[1]:
                refuse(f"has points = 1 but a range in {name}", "give at least two points")
        return self

    @model_validator(mode="after")
    def _measured_have_names(self) -> Self:
        names = [one.name for one in self.measured]
        if len(set(names)) < len(names):
            refuse("has two measured responses of one name", "name their files differently")
        if not names and self.measured_place == "instead":
            refuse('has measured_place = "instead" and nothing measured', "give measured files")
        return self

    @property
    def nominal_mass(self) -> float:
        """Mass of the nominal machine [kg]."""
        return self.mass[0] if self.nominal.mass is None else self.nominal.mass

    @property
    def nominal_delay(self) -> float:
        """Total delay of the nominal machine [s]."""
        return self.delay[0] if self.nominal.delay is None else self.nominal.delay


class Uncertainty(UncertaintySet):
    """The default set, and other sets by name."""

    sets: dict[str, UncertaintySet] = Field(default_factory=dict)

    def chosen(self, name: str) -> UncertaintySet:
        """Return the set of that name as a plain set; the default where the name is empty."""
        if name:
            return self.sets[name]
        values = {key: getattr(self, key) for key in UncertaintySet.model_fields}
        return UncertaintySet.model_construct(**values)


class Model(Section):
    """What the linear model includes."""

    measurement_path: Literal["none", "filters"] = Field(
        "none", description="measurement path in nominal and true plant"
    )
