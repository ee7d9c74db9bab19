"""How far the gain at F_ref may rise, as each more complete model sees it.

Eq. 17 and Eq. 21 leave the measurement path out and test each loop at its own break point. The same
question, asked of the true family, then with the path, then of the loop as it runs, gives other
answers; side by side they say what the inequalities do not see. Each link is the factor on K_P,vel
(which multiplies all of F_ref) at which stability is lost, or no longer guaranteed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from mptune.loops.broken import FORCE
from mptune.loops.family import FamilyLoops, nominal_plants
from mptune.loops.sampled import stable_as_sampled
from mptune.loops.stability import count_unstable_poles
from mptune.params.pack import (
    NO_PATH,
    LoopGains,
    MeasurementPath,
    Plants,
    pack_filters,
    pack_gains,
    pack_nominal,
    pack_path,
)
from mptune.robust.condition import sides
from mptune.robust.grid import first_grid, frequency_range
from mptune.robust.place import PlantPoint, finite, plant_point

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from mptune.arrays import BoolArray
    from mptune.robust.result import Family, SweepResult

LARGEST, SMALLEST = 64.0, 1 / 64.0  # factors beyond which nothing is searched
_STEPS = 30  # of a bisection
_DENSE = 3  # first grids laid into one another: the search does not refine


@dataclass(frozen=True)
class Link:
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
    """
    study = result.study
    gains, path = pack_gains(result.gains), pack_filters(study.study.controller)
    share_a, period = study.study.cylinder.share_a, study.study.controller.sampling_period
    links = [_inequalities(result, gains)]
    for family in result.families:
        one = NO_PATH if family.path == "none" else path
        name = "true family" if family.path == "none" else "with measurement path"
        links.append(_family_link(name, family, partial(_counted, share_a, gains, one)))
    if result.sampled is not None:
        as_sampled = partial(_as_sampled, share_a, gains, path, period)
        links.append(_family_link("sampled", result.sampled, as_sampled))
    return tuple(links)


def _scaled(gains: LoopGains, factor: float) -> LoopGains:
    return gains._replace(k_p_vel=factor * gains.k_p_vel)


def _counted(
    share_a: float, gains: LoopGains, path: MeasurementPath, plants: Plants, factor: float
) -> BoolArray:
    loops = FamilyLoops(FORCE, plants, share_a, _scaled(gains, factor), path)
    return count_unstable_poles(loops).stable


def _as_sampled(
    share_a: float,
    gains: LoopGains,
    path: MeasurementPath,
    period: float,
    plants: Plants,
    factor: float,
) -> BoolArray:
    return stable_as_sampled(plants, share_a, _scaled(gains, factor), path, period)[0]


def _inequalities(result: SweepResult, gains: LoopGains) -> Link:
    """Return the largest factor at which Eq. 17 and Eq. 21 hold, and the nominal loop is stable."""
    study, plants = result.study, result.plants
    nominal, path = pack_nominal(study), pack_path(study)
    share_a = study.study.cylinder.share_a
    low, high = frequency_range(plants, nominal, gains)
    omega = np.union1d(first_grid(low, _DENSE * high), result.omega)
    worst: PlantPoint | None = None

    def holds(factor: float) -> bool:
        nonlocal worst
        scaled = _scaled(gains, factor)
        found = sides(omega, plants, nominal, share_a, scaled, path)
        loop, place = np.unravel_index(int(np.argmax(found.ratio)), found.ratio.shape)
        one = nominal_plants(nominal)
        if found.ratio[loop, place] < 1:
            return bool(_counted(0.5, gains, path, one, factor)[0])
        worst = plant_point(plants, int(found.plant[loop, place]), float(omega[place]))
        return False

    factor = gain_limit(holds)
    return Link("Eq. 17 and 21", factor, worst)


def _family_link(name: str, family: Family, stable: Callable[[Plants, float], BoolArray]) -> Link:
    """Return the smallest gain margin of a family, or the factor that makes all of it stable.

    NaN where the plants that are stable as they are would not bear that factor.
    """
    if family.unstable_count == 0:
        factor, at = family.worst("gain_margin", FORCE)
        return Link(name, factor, at)
    failing = np.flatnonzero(~family.stable)
    plants = Plants(*(np.ascontiguousarray(column[failing]) for column in family.plants))
    factor = gain_limit(lambda factor: bool(stable(plants, factor).all()), 1e-4)
    least = family.margins.gain_reduction[FORCE][family.stable]
    if not np.isfinite(factor) or (least >= factor).any():
        return Link(name, float("nan"), None)
    last = np.flatnonzero(~stable(plants, 1.001 * factor))
    at = plant_point(plants, int(last[0]), float("nan")) if len(last) else None
    return Link(name, factor, at)
