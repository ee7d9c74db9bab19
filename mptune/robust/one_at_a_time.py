"""What drives each worst case: one parameter at a time varied from the worst plant."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mptune.params.packed import Plants
from mptune.robust.condition import sides

if TYPE_CHECKING:
    from mptune.robust.result import Condition, SweepResult

PARAMETERS = (
    ("mass", "kg", "m", "mass"),
    ("delay", "s", "d", "total delay"),
    ("tau_a", "s", "τ_A", "A-side time constant"),
    ("tau_b", "s", "τ_B", "B-side time constant"),
)
"""Name, unit, symbol and meaning of what varies in the family."""


@dataclass(frozen=True)
class Influence:
    """One parameter's hold on a condition's worst ratio.

    Attributes
    ----------
    condition
        ``"velocity"`` (Eq. 17) or ``"position"`` (Eq. 21).
    parameter
        Name of a field of ``Plants``.
    worst
        Its value in the worst plant, SI.
    ends
        Its range in the family, SI.
    ratios
        The worst ratio over frequency at either end, all else as in the worst plant.
    """

    condition: str
    parameter: str
    worst: float
    ends: tuple[float, float]
    ratios: tuple[float, float]

    @property
    def reach(self) -> float:
        """How far the ratio moves between the ends."""
        return abs(self.ratios[1] - self.ratios[0])


def one_at_a_time(result: SweepResult) -> tuple[Influence, ...]:
    """Return the drivers of both conditions, strongest first; none for a measured worst member.

    Only the ends of a range are tried. The frequencies are the sweep's own: between them a ratio
    may be a little higher than the one found.
    """
    found: list[Influence] = []
    for row, condition in enumerate(result.conditions):
        if condition.at.response is None:
            rows = _of_condition(result, row, condition)
            found += sorted(rows, key=lambda one: one.reach, reverse=True)
    return tuple(found)


def _of_condition(result: SweepResult, row: int, condition: Condition) -> list[Influence]:
    model = result.model
    worst = np.concatenate(model.plant(condition.at))
    ends = [(float(column.min()), float(column.max())) for column in model.plants]
    tried = np.repeat(worst[:, None], 2 * len(ends), axis=1)
    for parameter, pair in enumerate(ends):
        tried[parameter, 2 * parameter : 2 * parameter + 2] = pair
    plants = Plants(*np.ascontiguousarray(tried))
    both = sides(result.omega, model.loops(result.gains, plants=plants), model.nominal)
    ratios = both.plant_ratio[row].reshape(-1, 2)
    return [
        Influence(
            condition=condition.name,
            parameter=name,
            worst=float(worst[n]),
            ends=ends[n],
            ratios=(float(ratios[n, 0]), float(ratios[n, 1])),
        )
        for n, (name, *_) in enumerate(PARAMETERS)
    ]
