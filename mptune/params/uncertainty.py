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
    delay_as_it_runs: float | None = quantity(
        "s", "d_min,r", "nominal delay beside an explicit path", None, at_least=1e-6, at_most=1
    )


class UncertaintySet(Section):
    """A box of mass, total delay and pressure time constants.

    ``delay`` is the lumped one of Eq. 14 to 21: what measuring and filtering cost may be counted
    in it. Where the measurement path or the sampling stands explicitly, ``delay_as_it_runs`` takes
    its place, so that nothing is counted twice. A study that is loaded holds both as ranges.
    """

    mass: Range = quantity("kg", "m", "effective inertia", at_least=10, at_most=1e7)
    delay: Range | Derived = quantity(
        "s", "d", "total delay: half a sampling period, valve, computation; or derived",
        at_least=1e-6, at_most=1, words=("derived",),
    )  # fmt: skip
    delay_as_it_runs: Range | Derived | None = quantity(
        "s", "d_r", "total delay where path and sampling are explicit; or derived", None,
        at_least=1e-6, at_most=1, words=("derived",),
    )  # fmt: skip
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
        for name in ("mass", "delay", "delay_as_it_runs", "tau_a", "tau_b"):
            pair = getattr(self, name)
            if self.points == 1 and isinstance(pair, tuple) and pair[0] != pair[1]:
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
    def lumped_delay(self) -> Range:
        """Range of the total delay of Eq. 14 to 21 [s].

        Raises
        ------
        TypeError
            If it is still to be derived, as ``load_study`` does.
        """
        return _range(self.delay)

    @property
    def explicit_delay(self) -> Range:
        """Range of the total delay where path and sampling are explicit [s]; else as above."""
        given = self.delay_as_it_runs
        return self.lumped_delay if given is None else _range(given)

    @property
    def nominal_delay(self) -> float:
        """Total delay of the nominal machine of Eq. 14 to 21 [s]."""
        return self.lumped_delay[0] if self.nominal.delay is None else self.nominal.delay

    @property
    def nominal_delay_as_it_runs(self) -> float:
        """Total delay of the nominal machine where path and sampling are explicit [s]."""
        if self.nominal.delay_as_it_runs is not None:
            return self.nominal.delay_as_it_runs
        same = self.explicit_delay == self.lumped_delay
        return self.nominal_delay if same else self.explicit_delay[0]

    def with_delays(self, summed: Range) -> Self:
        """Return the set with delays that are to be derived replaced by the sum given [s]."""
        names = ("delay", "delay_as_it_runs")
        derived = [name for name in names if isinstance(getattr(self, name), str)]
        return self.model_copy(update=dict.fromkeys(derived, summed))


def _range(delay: Range | Derived) -> Range:
    if isinstance(delay, str):
        raise TypeError("a derived delay is a range once the study is loaded by load_study")
    return delay


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
