"""What a sweep found: frozen, with a status and the plant and frequency responsible."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.arrays import frozen
from mptune.loops.broken import FORCE
from mptune.loops.family import derived_time_constants
from mptune.robust.place import PlantPoint, finite, plant_point

if TYPE_CHECKING:
    from mptune.arrays import BoolArray, FloatArray, IntArray
    from mptune.params.controller import Gains
    from mptune.params.pack import Plants
    from mptune.params.study import ResolvedStudy
    from mptune.robust.margins import Margins
    from mptune.robust.measured import Members
    from mptune.robust.model import LinearModel


class Status(StrEnum):
    """How a condition or a requirement came out."""

    SATISFIED = "satisfied"
    VIOLATED = "violated"
    UNSTABLE = "unstable"  # a premise of the theorem fails: a nominal loop is not stable
    UNDECIDED = "undecided"  # a loop passes through the critical point as far as can be told
    NOT_CONVERGED = "not converged"  # the worst ratio still moved when refinement ended
    NOT_EVALUATED = "not evaluated"  # the study leaves no loop on which it could be checked


@dataclass(frozen=True)
class Condition:
    """Eq. 17 or Eq. 21 over the family.

    Attributes
    ----------
    name
        ``"velocity"`` (Eq. 17) or ``"position"`` (Eq. 21).
    left, right
        ``(F,)`` envelope of |Δ| over the family, and |(1 + L_N)/L_N|.
    plant
        ``(F,)`` the plant behind each value of the envelope, measured members after the box's.
    plant_ratio
        ``(N,)`` each plant's largest left/right ratio, in the same order.
    allowed
        ``(F,)`` largest ratio that the study allows.
    worst_ratio, at
        Largest ratio over plants and frequencies, and where. A finite grid can only miss higher
        values, so the figure errs on the optimistic side.
    worst_use, worst_use_at
        Largest quotient of ratio and allowed ratio, and where.
    low_frequency_limit
        The worst ratio is the limit of vanishing frequency, |m_min/m − 1|, which no gain changes.
    nominal_stable, poles_equal
        The theorem's premises: the nominal closed loop is stable; nominal and true open loops have
        the same number of unstable poles.
    """

    name: str
    left: FloatArray
    right: FloatArray
    plant: IntArray
    plant_ratio: FloatArray
    allowed: FloatArray
    worst_ratio: float
    at: PlantPoint
    worst_use: float
    worst_use_at: PlantPoint
    low_frequency_limit: bool
    nominal_stable: bool
    poles_equal: bool
    status: Status

    @property
    def ratio(self) -> FloatArray:
        """``(F,)``: left over right."""
        return np.asarray(self.left / self.right)

    @property
    def margin(self) -> float:
        """Factor by which the family's error may grow before the condition fails."""
        return 1 / self.worst_ratio if self.worst_ratio > 0 else np.inf

    @property
    def satisfied(self) -> bool:
        """Whether the requirement and the theorem's premises hold."""
        return self.status is Status.SATISFIED


@dataclass(frozen=True)
class Family:
    """The true family's stability and margins, with or without the measurement path.

    Attributes
    ----------
    path
        ``"none"``, ``"filters"``, or ``"sampled"`` for the loop as it runs.
    plants
        The box's plants, then the measured members; those alone where they stand instead.
    velocity_stable, stable
        ``(N,)`` whether the velocity loop alone and the whole closed loop are stable.
    decided
        ``(N,)`` whether both were decided for certain.
    margins
        Margins ``(3, N)``, NaN where the loop is not stable.
    responses
        Names of the measured responses behind the last plants.
    """

    path: str
    plants: Plants
    velocity_stable: BoolArray
    stable: BoolArray
    decided: BoolArray
    margins: Margins
    responses: tuple[str, ...] = ()

    @property
    def unstable_count(self) -> int:
        """Number of plants whose closed loop is not certainly stable."""
        return int(np.sum(~self.stable))

    def worst(self, name: str, loop: int) -> tuple[float, PlantPoint | None]:
        """Return the worst value of one margin in one loop, and where it is.

        The place is None where the margin has no limit. The value is NaN where some plant is
        unstable: the family then has no such margin.
        """
        values = getattr(self.margins, name)[loop]
        if np.isnan(values).any():
            return float("nan"), None
        largest_is_worst = name.endswith("peak") or name == "gain_reduction"
        index = int(np.argmax(values) if largest_is_worst else np.argmin(values))
        frequency = self.margins[self.margins._fields.index(name) + 1][loop, index]
        at = None if np.isnan(frequency) else self.point(index, frequency)
        return float(values[index]), at

    def first_unstable(self) -> PlantPoint | None:
        """Return an unstable plant, the one with the least mass and then the largest lags."""
        index = np.flatnonzero(~self.stable)
        if len(index) == 0:
            return None
        plants = self.plants
        order = np.lexsort((-plants.tau_a[index], -plants.delay[index], plants.mass[index]))
        return self.point(int(index[order[0]]), float("nan"))

    def joined(self, members: Family) -> Family:
        """Return the family with its measured members behind the box's plants."""

        def both(key: str) -> BoolArray:
            return frozen(np.concatenate([getattr(self, key), getattr(members, key)]))

        margins = zip(self.margins, members.margins, strict=True)
        return Family(
            path=self.path,
            plants=self.plants.followed_by(members.plants),
            velocity_stable=both("velocity_stable"),
            stable=both("stable"),
            decided=both("decided"),
            margins=type(self.margins)(*(frozen(np.concatenate(pair, axis=1)) for pair in margins)),
            responses=members.responses,
        )

    def point(self, index: int, frequency: float) -> PlantPoint:
        """Return one plant of the family at a frequency [rad/s]."""
        return plant_point(self.plants, index, frequency, self.responses)


@dataclass(frozen=True)
class Check:
    """One requirement of the study: its limit, what was found, and where."""

    name: str
    limit: str
    found: float
    status: Status
    at: PlantPoint | None


@dataclass(frozen=True)
class SweepResult:
    """Both conditions and the true family's margins for one set of gains.

    ``plants`` are those of the box; measured ``members`` stand beside or instead of them.
    """

    model: LinearModel
    gains: Gains
    omega: FloatArray
    velocity: Condition
    position: Condition
    families: tuple[Family, ...]  # without and with the measurement path
    sampled: Family | None  # as it runs; None where some delay leaves no room for the hold
    noise_gain: float  # N/m, rms of F_ref per rms of position noise
    checks: tuple[Check, ...]

    @property
    def study(self) -> ResolvedStudy:
        """The study that was swept."""
        return self.model.study

    @property
    def plants(self) -> Plants:
        """``(N,)`` the box's plants."""
        return self.model.plants

    @property
    def members(self) -> Members | None:
        """Measured members of the family, if any."""
        return self.model.members

    @property
    def conditions(self) -> tuple[Condition, Condition]:
        """Eq. 17 and Eq. 21."""
        return self.velocity, self.position

    @property
    def satisfied(self) -> bool:
        """Whether every requirement of the study is met."""
        return all(check.status is Status.SATISFIED for check in self.checks)

    def family(self, path: str) -> Family:
        """Return the true family with the path ``"none"`` or ``"filters"``."""
        return next(family for family in self.families if family.path == path)

    def json(self) -> dict[str, Any]:
        """Return the result in SI, units in the keys."""
        values: dict[str, Any] = {}
        for condition in self.conditions:
            values[condition.name] = {
                "worst_ratio": condition.worst_ratio,
                "margin": finite(condition.margin),
                "satisfied": condition.satisfied,
                "status": condition.status.value,
                "nominal_stable": condition.nominal_stable,
                "poles_equal": condition.poles_equal,
                "low_frequency_limit": condition.low_frequency_limit,
                "at": condition.at.values(),
            }
        values["true_family"] = {family.path: _family_json(family) for family in self.families}
        if self.sampled is not None:
            values["true_family"]["sampled"] = _family_json(self.sampled)
        values["noise_gain_n_per_m"] = self.noise_gain
        values["requirements"] = [
            {
                "name": check.name,
                "limit": check.limit,
                "found": finite(check.found),
                "status": check.status.value,
                "at": check.at.values() if check.at else None,
            }
            for check in self.checks
        ]
        values["satisfied"] = self.satisfied
        tau_a, tau_b = derived_time_constants(self.study)  # Eq. 4 and 12, beside the set's own
        values["derived_time_constants"] = {"tau_a_s": list(tau_a), "tau_b_s": list(tau_b)}
        return values


@dataclass(frozen=True)
class MarginFigure:
    """A margin that is reported: its field, its key in JSON, its label and factor in print."""

    name: str
    key: str
    label: str
    factor: float


MARGINS = (
    MarginFigure("sensitivity_peak", "sensitivity_peak", "M_S", 1.0),
    MarginFigure("complementary_peak", "complementary_peak", "M_T", 1.0),
    MarginFigure("gain_margin", "gain_margin", "gain margin", 1.0),
    MarginFigure("gain_reduction", "gain_reduction", "gain reduction", 1.0),
    MarginFigure("phase_margin", "phase_margin_rad", "phase margin [°]", 180 / np.pi),
    MarginFigure("delay_margin", "delay_margin_s", "delay margin [ms]", 1e3),
    MarginFigure("disk_margin", "disk_margin", "disk margin α", 1.0),
)


def _family_json(family: Family) -> dict[str, Any]:
    unstable = family.first_unstable()
    values: dict[str, Any] = {
        "plants": len(family.stable),
        "unstable_plants": family.unstable_count,
        "undecided_plants": int(np.sum(~family.decided)),
        "unstable_at": unstable.values() if unstable else None,
    }
    sampled = family.path == "sampled"
    for loop, name in enumerate(("velocity_loop", "position_loop", "force_loop")):
        if sampled and loop != FORCE:
            continue
        values[name] = {}
        for figure in MARGINS:
            if sampled and figure.name == "delay_margin":
                continue
            value, at = family.worst(figure.name, loop)
            values[name][figure.key] = {"worst": finite(value), "at": at.values() if at else None}
    return values
