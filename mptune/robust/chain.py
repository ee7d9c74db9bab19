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

from mptune.certify.margins import TOLERANCE, margin
from mptune.certify.result import Stability
from mptune.loops.broken import FORCE
from mptune.loops.stability import count_unstable_poles
from mptune.robust.certificates import place_of
from mptune.robust.condition import sides
from mptune.robust.families import as_sampled, stable_plants, true_family
from mptune.robust.grid import first_grid, frequency_range
from mptune.robust.place import PlantPoint, finite, plant_point
from mptune.summary import Summarised

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from mptune.arrays import BoolArray, IntArray
    from mptune.certify.problem import BoxedLoop
    from mptune.certify.result import Bracket
    from mptune.robust.family import Family
    from mptune.robust.result import SweepResult

LARGEST, SMALLEST = 64.0, 1 / 64.0  # factors beyond which nothing is searched
GAIN_RESERVE = 1.1  # a factor below it is no reserve: a verdict rests on it
_STEPS = 30  # of a bisection
_FINEST = 1e-4  # relative width of a bracket that lies across the reserve
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
    guaranteed
        Factor up to which every plant of the box is proved stable; NaN where nothing is proved.
    stability
        What is known of the model as it is.
    witness
        A plant that is unstable, or undecided, as it is.
    note
        What else is to be said: how many plants are unstable, which machine.
    beside
        Shown beside the others, no verdict rests on it: another reading of the delays, or around a
        state estimator what leaves that out.
    """

    name: str
    factor: float
    at: PlantPoint | None
    guaranteed: float = float("nan")
    stability: Stability = Stability.STABLE
    witness: PlantPoint | None = None
    note: str = ""
    beside: bool = False

    @property
    def safe(self) -> float:
        """The factor that a verdict may rest on: what is proved, else what was found."""
        return self.factor if np.isnan(self.guaranteed) else min(self.guaranteed, self.factor)

    @property
    def headline(self) -> str:
        """The model and its factor."""
        return f"{self.name}: {factor_text(self.factor)}"

    def json(self) -> dict[str, Any]:
        """Return the link, as JSON has it."""
        at = self.at.values() if self.at else None
        values = {
            "model": self.name,
            "gain_factor": finite(self.factor),
            "guaranteed_gain_factor": finite(self.guaranteed),
            "stability": self.stability.value,
            "at": at,
        }
        return {**values, "beside": True} if self.beside else values


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
    low, high = 1.0, 2.0
    if holds(1.0):
        while holds(high):
            low, high = high, 2 * high
            if low >= LARGEST:
                return float("inf")
    else:
        low, high = 0.5, 1.0
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
    side. What is guaranteed beside it errs on the low side.

    Parameters
    ----------
    result
        The sweep of the gains asked about.
    """
    links = [_inequalities(result)]
    links += [_family_link(_NAMES[family.path], family, result) for family in result.families]
    if result.model.estimated:  # no velocity loop stands apart: for information
        links[:2] = [replace(link, beside=True) for link in links[:2]]
    if result.sampled is not None:
        links.append(_family_link("sampled", result.sampled, result))
    return tuple(links)


def other_reading(result: SweepResult) -> tuple[Link, ...]:
    """Return the links with path and sampling, the lumped delays counted beside them as well.

    That is the reading in which nothing of the lumped delay stands for the measurement path: it
    errs towards instability where something does. None where both delays have one range.
    """
    model = result.model
    box = model.study.uncertainty
    if box.explicit_delay == box.lumped_delay:
        return ()
    lumped = replace(model, explicit=model.lumped)
    gains = lumped.loops(result.gains).gains
    families = (
        true_family(lumped, gains, "filters", result.omega),
        as_sampled(lumped, gains, result.omega),
    )
    again = replace(result, model=lumped, certificates=None)
    return tuple(
        replace(_family_link(f"{name}, lumped delay", family, again), beside=True)
        for name, family in zip((_NAMES["filters"], "sampled"), families, strict=True)
        if family is not None
    )


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
    """Return a family's gain factor, what is proved of it, and whether it is stable as it is."""
    unstable = family.decided & ~family.stable
    count = f"{int(unstable.sum())} of {len(family.stable)} plants are unstable"
    if unstable.any():
        factor, at = _restoring_factor(family, result)
        return Link(
            name, factor, at, float("nan"), Stability.UNSTABLE, family.first_unstable(), count
        )
    if not family.decided.all():
        return Link(
            name, float("nan"), None, float("nan"), Stability.UNDECIDED, family.first_unstable()
        )
    factor, at = family.worst("gain_margin", FORCE)
    proofs = result.certificates
    box = proofs.stable("force_reference", family.path) if proofs else None
    if proofs is None or box is None:
        return Link(name, factor, at)
    if box.status is not Stability.STABLE:
        place = place_of(box.witness or box.suspect)
        note = "a plant between those of the grid is unstable" if box.witness else ""
        return Link(name, float("nan"), place, float("nan"), box.status, place, note)
    found = _bracket(proofs.problem, family.path)
    if found.upper < factor:
        factor, at = found.upper, place_of(found.at)
    guaranteed = float("nan") if family.responses else found.lower  # of those nothing is proved
    return Link(name, factor, at, guaranteed)


def _bracket(problem: BoxedLoop, path: str) -> Bracket:
    """Return the gain margin over the box, fine enough to tell it from the reserve asked for."""
    tolerance = TOLERANCE
    found = margin(problem, path, "gain_margin", tolerance=tolerance)
    while found.lower < GAIN_RESERVE <= found.upper and tolerance > _FINEST:
        tolerance /= 10
        found = margin(problem, path, "gain_margin", tolerance=tolerance)
    return found


def _restoring_factor(family: Family, result: SweepResult) -> tuple[float, PlantPoint | None]:
    """Return the factor that makes all of a family stable, and the plant that asks for it.

    NaN where the plants that are stable as they are would not bear that factor.
    """
    failing = np.flatnonzero(~family.stable)
    likely = failing[:1]  # the one that failed last is asked first: one is enough

    def stable(factor: float, rows: IntArray = failing) -> BoolArray:
        return stable_plants(result.model, result.gains, family, rows, factor)

    def holds(factor: float) -> bool:
        nonlocal likely
        if not stable(factor, likely).all():
            return False
        found = stable(factor)
        if not found.all():
            likely = failing[~found][:1]
        return bool(found.all())

    factor = gain_limit(holds, 1e-4)
    least = family.margins.gain_reduction[FORCE][family.stable]
    if not np.isfinite(factor) or (least >= factor).any():
        return float("nan"), None
    last = failing[~stable(1.001 * factor)]
    return factor, family.point(int(last[0]), float("nan")) if len(last) else None
