"""Two sets of gains on the same machines with the same seeds: what became better, what worse.

The simulator is chaotic, so that two runs differ even where the gains do not. A figure counts as
changed only where the means over sets and seeds differ by more than one set scatters about its
machine's mean; within that they are equal. A single set of a single seed has no scatter: there any
change counts.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.sim.merit import merit
from mptune.strict import strict
from mptune.summary import Summarised

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from mptune.arrays import FloatArray
    from mptune.sim.merit import Merit
    from mptune.verify.result import CaseResult, VerifyResult

FIGURES = (
    "performance_index_ms",
    "energy_loss_j_per_mm",
    "force_error_integral_kn2s",
    "final_error_mm",
    "valve_switches",
)


class Mark(StrEnum):
    """How a figure changed."""

    BETTER = "better"
    EQUAL = "equal"  # within what sets and seeds scatter by
    WORSE = "worse"


@dataclass(frozen=True)
class Change(Summarised):
    """One figure of one mass, before and after.

    Attributes
    ----------
    mass_kg, key
        The machines' mass, and the figure of merit.
    before, after
        The figure over all machines, seeds and sets of that mass, in its own unit.
    spread
        By how much one set scatters about its machine's mean, rms of both; in the same unit.
    """

    mass_kg: float
    key: str
    before: float
    after: float
    spread: float
    mark: Mark

    @property
    def headline(self) -> str:
        """Mass, figure and how it changed."""
        one = merit(self.key)
        return (
            f"{self.mass_kg / 1e3:g} t, {one.short}: {one.text(self.before)} → "
            f"{one.text(self.after)} {one.printed_unit}, {self.mark}"
        )

    def json(self) -> dict[str, Any]:
        """Return the change; the figures keep the unit of their key."""
        return strict(
            {
                "mass_kg": self.mass_kg,
                "figure": self.key,
                "before": self.before,
                "after": self.after,
                "spread": self.spread,
                "mark": self.mark.value,
            }
        )


def changes(before: VerifyResult, after: VerifyResult) -> tuple[Change, ...]:
    """Return how each figure of each mass changed.

    Parameters
    ----------
    before, after
        The same machines with the same seeds, under two sets of gains.
    """
    masses = dict.fromkeys(case.mass_kg for case in before.cases)
    return tuple(
        _change(
            mass,
            merit(key),
            [case for case in before.cases if case.mass_kg == mass],
            [case for case in after.cases if case.mass_kg == mass],
        )
        for mass in masses
        for key in FIGURES
    )


def in_a_sentence(found: Iterable[Change], which: str = "the tuned gains") -> str:
    """Return what became better and worse, with the masses, and what stayed equal at all."""
    by_figure: dict[str, dict[Mark, list[Change]]] = defaultdict(lambda: defaultdict(list))
    for one in found:
        by_figure[one.key][one.mark].append(one)
    words = {
        mark: [
            _told(key, marks[mark], mark)
            for key, marks in by_figure.items()
            if (set(marks) == {mark} if mark is Mark.EQUAL else mark in marks)
        ]
        for mark in (Mark.BETTER, Mark.WORSE, Mark.EQUAL)
    }
    said = [f"{mark.value} in {', '.join(texts)}" for mark, texts in words.items() if texts]
    return f"On the machine {which} are {'; '.join(said)}." if said else ""


def named(key: str) -> str:
    """Return a figure's short name; the machine's index by its whole one, as others have theirs."""
    one = merit(key)
    return one.label.lower() if key == "performance_index_ms" else one.short


def _told(key: str, ones: Sequence[Change], mark: Mark) -> str:
    name = named(key)
    if mark is Mark.EQUAL:
        return name
    return f"{name} ({', '.join(f'{change.mass_kg / 1e3:g} t' for change in ones)})"


def _change(
    mass: float, one: Merit, before: Sequence[CaseResult], after: Sequence[CaseResult]
) -> Change:
    values = [_by_machine(one, cases) for cases in (before, after)]
    figures = [one.of_sets(np.concatenate(of_one)) for of_one in values]
    spread = float(np.sqrt(np.mean([_scatter(of_one) ** 2 for of_one in values])))
    stable = [sum(case.stable for case in cases) for cases in (before, after)]
    loss = one.badness(figures[1]) - one.badness(figures[0])
    if stable[0] != stable[1]:
        mark = Mark.WORSE if stable[1] < stable[0] else Mark.BETTER
    elif abs(loss) > spread:
        mark = Mark.WORSE if loss > 0 else Mark.BETTER
    else:
        mark = Mark.EQUAL
    return Change(mass, one.key, figures[0], figures[1], spread, mark)


def _by_machine(one: Merit, cases: Iterable[CaseResult]) -> list[FloatArray]:
    """Return a figure's values of all sets and seeds, machine by machine."""
    machines: dict[tuple[Any, ...], list[float]] = defaultdict(list)
    for case in cases:
        machine = case.valve_delay_s, case.oil_bulk_modulus_pa, case.load_force_n
        machines[machine] += [float(getattr(figures, one.key)) for figures in case.sets]
    return [np.array(values) for values in machines.values()]


def _scatter(machines: Sequence[FloatArray]) -> float:
    """Return the rms deviation of a set from its machine's mean; 0 where each ran but one."""
    freedom = sum(len(values) - 1 for values in machines if len(values))
    squares = sum(
        float(((values - values.mean()) ** 2).sum()) for values in machines if len(values)
    )
    return float(np.sqrt(squares / freedom)) if freedom else 0.0
