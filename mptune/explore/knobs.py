"""What can be turned by hand: which values of a study, in which unit, and how far a slider goes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mptune.params.controller import Controller, Feedforward, Gains
from mptune.params.estimator import Estimator
from mptune.params.uncertainty import UncertaintySet

if TYPE_CHECKING:
    from mptune.params.section import Range, Section
    from mptune.params.study import ResolvedStudy

SECTIONS: dict[str, type[Section]] = {
    "gains": Gains,
    "controller": Controller,
    "estimator": Estimator,
    "feedforward": Feedforward,
    "uncertainty": UncertaintySet,
}
"""The sections whose values can be turned; ``uncertainty`` is the chosen set."""

_STEPS = 200  # of a slider's way


@dataclass(frozen=True)
class Knob:
    """One value that can be turned.

    Attributes
    ----------
    key
        Section and name, ``"gains.k_p_vel"``.
    unit, scale
        The unit that the page shows, and how many SI units it is.
    reach
        How far the slider goes where the study's own value is 0 or says nothing, in SI.
    """

    key: str
    unit: str
    scale: float
    reach: float = 0.0

    @property
    def section(self) -> str:
        """The section's name."""
        return self.key.partition(".")[0]

    @property
    def name(self) -> str:
        """The value's name in its section."""
        return self.key.partition(".")[2]

    @property
    def is_range(self) -> bool:
        """Whether it is a smallest and a largest value."""
        return SECTIONS[self.section].is_range(self.name)

    @property
    def bounds(self) -> Range:
        """The least and the largest value that a study may have, in SI."""
        return SECTIONS[self.section].bounds_of(self.name)

    @property
    def si_unit(self) -> str:
        """The unit in which the value is kept."""
        return str(self._extra["unit"])

    @property
    def symbol(self) -> str:
        """The paper's symbol."""
        return str(self._extra["symbol"])

    @property
    def meaning(self) -> str:
        """What it is."""
        return SECTIONS[self.section].model_fields[self.name].description or ""

    @property
    def _extra(self) -> Any:
        return SECTIONS[self.section].model_fields[self.name].json_schema_extra

    def value_in(self, study: ResolvedStudy) -> float | Range:
        """Return a study's own value, in SI."""
        found = getattr(section_of(study, self.section), self.name)
        if found is None and self.key == "uncertainty.delay_as_it_runs":
            return study.uncertainty.explicit_delay
        if found is None and self.name == "position_filter":
            return study.study.controller.position_filter
        if found is None:  # the estimator's mass: the least of the family
            return study.uncertainty.mass[0]
        if isinstance(found, str):  # derived
            from mptune.loops.family import ranges_of

            return ranges_of(study)[2 if self.name == "tau_a" else 3]
        pair: float | Range = found
        return pair

    def ends(self, study: ResolvedStudy) -> tuple[float, float, float]:
        """Return the slider's ends and its step, in SI, about the study's own value."""
        own = self.value_in(study)
        least, largest = self.bounds
        top = own[1] if isinstance(own, tuple) else own
        low = max(least, (own[0] if isinstance(own, tuple) else own) / 5)
        high = min(largest, 2.5 * top if top > 0 else self.reach)
        if not low < high:
            low, high = least, max(self.reach, least + 1e-9)
        step = 10 ** math.floor(math.log10((high - low) / _STEPS))
        step *= next(n for n in (1, 2, 5, 10) if (high - low) / (n * step) <= _STEPS)
        first, last = math.floor(low / step + 1e-9) * step, math.ceil(high / step - 1e-9) * step
        return max(_tidy(first), least), min(_tidy(last), largest), _tidy(step)


GROUPS: dict[str, tuple[Knob, ...]] = {
    "Gains": (
        Knob("gains.k_p_vel", "kN s/m", 1e3),
        Knob("gains.k_p_pos", "1/s", 1.0, 30.0),
        Knob("gains.k_i_pos", "1/s²", 1.0, 100.0),
        Knob("gains.omega", "rad/s", 1.0),
        Knob("gains.xi", "–", 1.0, 2.0),
        Knob("gains.tau", "ms", 1e-3),
    ),
    "Uncertainty": (
        Knob("uncertainty.mass", "t", 1e3),
        Knob("uncertainty.delay", "ms", 1e-3),
        Knob("uncertainty.delay_as_it_runs", "ms", 1e-3),
        Knob("uncertainty.tau_a", "ms", 1e-3, 20e-3),
        Knob("uncertainty.tau_b", "ms", 1e-3, 20e-3),
    ),
    "Filters and estimator": (
        Knob("estimator.position_filter", "ms", 1e-3),
        Knob("estimator.bandwidth", "rad/s", 1.0),
        Knob("estimator.mass", "t", 1e3),
    ),
    "Feed-forward": (
        Knob("feedforward.acceleration_mass", "t", 1e3, 60e3),
        Knob("feedforward.reference_lag", "ms", 1e-3, 40e-3),
        Knob("feedforward.velocity_reference_lag", "ms", 1e-3, 40e-3),
        Knob("feedforward.preview", "ms", 1e-3, 40e-3),
        Knob("feedforward.viscous_friction", "kN s/m", 1e3, 20e3),
        Knob("feedforward.coulomb_friction", "N", 1.0, 3000.0),
    ),
}
"""Every knob, by the group that it stands in."""

KNOBS: dict[str, Knob] = {knob.key: knob for group in GROUPS.values() for knob in group}
"""Every knob by its key."""


def _tidy(value: float) -> float:
    """Return a value without the digits that rounding leaves."""
    return float(f"{value:.12g}")


def section_of(study: ResolvedStudy, name: str) -> Section:
    """Return a section of a study; of ``uncertainty`` the chosen set."""
    if name == "uncertainty":
        return study.uncertainty
    found: Section = getattr(study.study, name)
    return found
