"""How far the gain at F_ref may rise, as each more complete model sees it.

Eq. 17 and Eq. 21 leave the measurement path out and test each loop at its own break point. The same
question, asked of the true family, then with the path, then of the loop as it runs, gives other
answers; side by side they say what the inequalities do not see. Each link is the factor on K_P,vel
(which multiplies all of F_ref) at which stability is lost, or no longer guaranteed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from mptune.loops.broken import FORCE
from mptune.loops.stability import count_unstable_poles
from mptune.robust.condition import sides
from mptune.robust.families import stable_plants
from mptune.robust.grid import first_grid, frequency_range
from mptune.robust.place import PlantPoint, finite, plant_point
from mptune.summary import Summarised

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from mptune.arrays import BoolArray
    from mptune.robust.family import Family
    from mptune.robust.result import SweepResult

LARGEST, SMALLEST = 64.0, 1 / 64.0  # factors beyond which nothing is searched
_STEPS = 30  # of a bisection
_NAMES = {
    "none": "true family",
    "filters": "with measurement path",
    "estimator": "with state estimator",
}
_DENSE = 3  # first grids laid into one another: the search does not refine


@dataclass(frozen=True)
class Link(Summarised):
    """One model's answer.

    Attributes
    ----------
    name
        The model.
    factor
        Factor on the gain at F_ref; below 1 where the loop is not stable (or not guaranteed) as it
        is, NaN where it cannot be told.
    at
        The plant and frequency that limit it; None where it is not known.
    """

    name: str
    factor: float
    at: PlantPoint | None

    @property
    def headline(self) -> str:
        """The model and its factor."""
        return f"{self.name}: {factor_text(self.factor)}"

    def json(self) -> dict[str, Any]:
        """Return the link, as JSON has it."""
        at = self.at.values() if self.at else None
        return {"model": self.name, "gain_factor": finite(self.factor), "at": at}


def factor_text(factor: float) -> str:
    """Return a factor for print."""
    if np.isnan(factor):
        return "cannot be told"
    return f"above {LARGEST:g}" if np.isinf(factor) else f"{factor:.3f}"


def gain_limit(holds: Callable[[float], bool], relative: float = 1e-6) -> float:
    """Return the largest factor, grown from 1 or shrunk to below it, up to which ``holds`` is true.

    One crossing is assumed between the factors tried: doubling, or halving, then bisection until
    the bracket is ``relative`` wide. NaN where even the smallest factor does not hold.
    """
    low, high = 1.0, 1.0
    if holds(1.0):
        while holds(high):
            low, high = high, 2 * high
            if low >= LARGEST:
                return float("inf")
    else:
        while not holds(low):
            low, high = low / 2, low
            if high <= SMALLEST:
                return float("nan")
    for _ in range(_STEPS):
        if high / low - 1 <= relative:
            break
        middle = (low * high) ** 0.5
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def chain(result: SweepResult) -> tuple[Link, ...]:
    """Return the linear links: Eq. 17 and 21, true family, with path, sampled.

    A finite grid of plants and frequencies can only miss worse ones: every factor errs on the high
    side.

    Parameters
    ----------
    result
        The sweep of the gains asked about.
    """
    links = [_inequalities(result)]
    links += [_family_link(_NAMES[family.path], family, result) for family in result.families]
    if result.sampled is not None:
        links.append(_family_link("sampled", result.sampled, result))
    return tuple(links)


def _inequalities(result: SweepResult) -> Link:
    """Return the largest factor at which Eq. 17 and Eq. 21 hold, and the nominal loop is stable."""
    model = result.model
    nominal = model.nominal_loop(result.gains)
    low, high = frequency_range(model.plants, model.nominal, nominal.gains)
    omega = np.union1d(first_grid(low, _DENSE * high), result.omega)
    worst: PlantPoint | None = None

    def holds(factor: float) -> bool:
        nonlocal worst
        scaled = nominal.scaled(factor)
        found = sides(omega, replace(scaled, plants=model.plants), model.nominal)
        loop, place = np.unravel_index(int(np.argmax(found.ratio)), found.ratio.shape)
        if found.ratio[loop, place] < 1:
            return bool(count_unstable_poles(scaled).stable[0])
        worst = plant_point(model.plants, int(found.plant[loop, place]), float(omega[place]))
        return False

    factor = gain_limit(holds)
    return Link("Eq. 17 and 21", factor, worst)


def _family_link(name: str, family: Family, result: SweepResult) -> Link:
    """Return the smallest gain margin of a family, or the factor that makes all of it stable.

    NaN where the plants that are stable as they are would not bear that factor.
    """
    if family.unstable_count == 0:
        factor, at = family.worst("gain_margin", FORCE)
        return Link(name, factor, at)
    failing = np.flatnonzero(~family.stable)

    def stable(factor: float) -> BoolArray:
        return stable_plants(result.model, result.gains, family, failing, factor)

    factor = gain_limit(lambda factor: bool(stable(factor).all()), 1e-4)
    least = family.margins.gain_reduction[FORCE][family.stable]
    if not np.isfinite(factor) or (least >= factor).any():
        return Link(name, float("nan"), None)
    last = failing[~stable(1.001 * factor)]
    return Link(name, factor, family.point(int(last[0]), float("nan")) if len(last) else None)
