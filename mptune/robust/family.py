"""The true family's stability and margins, one result per measurement path."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.arrays import frozen
from mptune.loops.broken import FORCE, NAMES
from mptune.robust.place import PlantPoint, finite, plant_point
from mptune.summary import Summarised

if TYPE_CHECKING:
    from mptune.arrays import BoolArray
    from mptune.params.packed import Plants
    from mptune.robust.margins import Margins


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
    MarginFigure("peak_compliance", "peak_compliance_m_per_n", "compliance [mm/kN]", 1e6),
)


@dataclass(frozen=True, repr=False)
class Family(Summarised):
    """The true family's stability and margins, with or without the measurement path.

    Attributes
    ----------
    path
        ``"none"``, ``"filters"`` or ``"estimator"``, or ``"sampled"`` for the loop as it runs; of
        the last two there is but the loop at F_ref.
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
    def headline(self) -> str:
        """How many plants are not certainly stable."""
        return f"path {self.path}: {self.unstable_count} of {len(self.stable)} plants not stable"

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
        largest_is_worst = "peak" in name or name == "gain_reduction"
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

    def json(self) -> dict[str, Any]:
        """Return the worst of each margin in SI, units in the keys; None where there is none."""
        unstable = self.first_unstable()
        values: dict[str, Any] = {
            "plants": len(self.stable),
            "unstable_plants": self.unstable_count,
            "undecided_plants": int(np.sum(~self.decided)),
            "unstable_at": unstable.values() if unstable else None,
        }
        sampled = self.path == "sampled"
        for loop, name in enumerate(f"{name}_loop" for name in NAMES):
            if loop != FORCE and self.path in {"estimator", "sampled"}:
                continue
            values[name] = {}
            for figure in MARGINS:
                if sampled and figure.name == "delay_margin":
                    continue
                if loop != FORCE and figure.name == "peak_compliance":
                    continue
                value, at = self.worst(figure.name, loop)
                values[name][figure.key] = {
                    "worst": finite(value),
                    "at": at.values() if at else None,
                }
        return values
