"""What a verification found: one frozen result per machine, with a status and §7's figures."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from mptune.interop import Drawn, Labelled, to_pandas
from mptune.sim.judge import per_year, worst_per_mass
from mptune.sim.merit import MERITS, merit
from mptune.strict import strict
from mptune.summary import Summarised

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd

    from mptune.arrays import FloatArray
    from mptune.params.controller import Feedforward, Gains
    from mptune.params.study import ResolvedStudy
    from mptune.sim.judge import SetFigures
    from mptune.sim.record import RunRecord

_INDEX = "performance_index_ms"


class CaseStatus(StrEnum):
    """How the closed loop behaved."""

    STABLE = "stable"
    LIMIT_CYCLE = "limit cycle"  # sustained oscillation about the velocity reference
    SATURATED = "saturated"  # the force reference stood at its limit
    LIMIT_BROKEN = "limit broken"  # piston or converter at its end, or a supply ran empty
    NOT_FINITE = "not finite"  # the simulation left the numbers that it can hold


@dataclass(frozen=True, repr=False)
class CaseResult(Summarised):
    """One machine's verification.

    Attributes
    ----------
    sets
        The figures of every movement set but the first, which is left out of statistics.
    broken, broken_at_s
        Which limit was broken first, and when; empty and NaN where none was.
    record
        The neutral record of the last set.
    traces
        ``(T, 12 + K)`` of the last set, columns as in ``mptune.sim.closed_loop``.
    states
        How many valve states of one side there are of each kind, the closed one first.
    converters
        How many converter cylinders the machine has.
    """

    mass_kg: float
    valve_delay_s: tuple[float, float]
    oil_bulk_modulus_pa: float
    load_force_n: float
    seed: int
    status: CaseStatus
    broken: str
    broken_at_s: float
    sets: tuple[SetFigures, ...]
    record: RunRecord
    traces: FloatArray
    states: tuple[int, ...] = ()
    converters: int = 0

    @property
    def headline(self) -> str:
        """The machine, its status and its index."""
        index = self.mean(_INDEX)
        return (
            f"{self.mass_kg / 1e3:g} t, oil {self.oil_bulk_modulus_pa / 1e6:g} MPa, "
            f"load {self.load_force_n / 1e3:g} kN, seed {self.seed}: {self.status}, "
            f"index {index:.4g} ms"
        )

    def to_pandas(self) -> pd.DataFrame:
        """Return one row per movement set, in §7's units."""
        import pandas as pd

        return pd.DataFrame([asdict(one) for one in self.sets])

    @property
    def stable(self) -> bool:
        """Whether the closed loop did what it should."""
        return self.status is CaseStatus.STABLE

    def mean(self, figure: str) -> float:
        """Return the mean of one figure over the sets."""
        return float(np.mean([getattr(one, figure) for one in self.sets])) if self.sets else np.nan

    def span(self, figure: str) -> tuple[float, float]:
        """Return the least and the largest value of one figure over the sets."""
        values = [getattr(one, figure) for one in self.sets] or [np.nan]
        return float(min(values)), float(max(values))

    def figure(self, key: str) -> float:
        """Return what counts of one figure over the sets, as ``mptune.sim.merit`` says."""
        return merit(key).of_sets(getattr(one, key) for one in self.sets)

    @property
    def badness(self) -> float:
        """Mean performance index [ms]; infinite where the loop is not stable, or has none."""
        index = self.mean(_INDEX)
        return index if self.stable and np.isfinite(index) else np.inf

    def json(self) -> dict[str, Any]:
        """Return the case; figures keep §7's units, and what there is none of is None."""
        return strict(
            {
                "mass_kg": self.mass_kg,
                "valve_delay_s": sum(self.valve_delay_s) / 2,
                "valve_delay_range_s": self.valve_delay_s,
                "oil_bulk_modulus_pa": self.oil_bulk_modulus_pa,
                "load_force_n": self.load_force_n,
                "seed": self.seed,
                "stable": self.stable,
                "status": self.status.value,
                "broken": self.broken or None,
                "broken_at_s": self.broken_at_s,
                **{one.key: self.figure(one.key) for one in MERITS},
                "performance_index_range_ms": self.span(_INDEX),
            }
        )


@dataclass(frozen=True, repr=False)
class VerifyResult(Summarised, Drawn, Labelled):
    """Every machine's verification with one set of gains."""

    drawings: ClassVar[Mapping[str, str]] = {"traces": "mptune.figures.machine:machine_traces"}
    dataset: ClassVar[str] = "mptune.verify.store:to_dataset"

    study: ResolvedStudy
    gains: Gains
    feedforward: Feedforward
    cases: tuple[CaseResult, ...]

    @property
    def headline(self) -> str:
        """Study, and how many machines are stable."""
        stable = sum(case.stable for case in self.cases)
        return f"Verification of {self.study.name}: {stable} of {len(self.cases)} machines stable"

    def _drawn_with(self, _drawing: str) -> tuple[Any, ...]:
        worst = max(self.worst_per_mass(), key=lambda case: case.badness)
        return worst, self.feedforward

    def to_pandas(self) -> pd.DataFrame:
        """Return one row per machine, columns as in JSON."""
        return to_pandas(self.cases)

    @property
    def satisfied(self) -> bool:
        """Whether every case is stable."""
        return all(case.stable for case in self.cases)

    def json(self) -> dict[str, Any]:
        """Return all cases."""
        return {
            "satisfied": self.satisfied,
            "gains": self.gains.model_dump(),
            "feedforward": self.feedforward.model_dump(),
            "duty": self.study.study.verification.duty,
            "cases": [
                strict({**case.json(), "busiest_valve_per_year": self.per_year(case)})
                for case in self.cases
            ],
        }

    def per_year(self, case: CaseResult) -> float:
        """Return the switches of a machine's busiest valve in a year at the study's duty."""
        busiest = case.figure("busiest_valve_per_s")
        return per_year(busiest, self.study.study.verification.duty)

    @property
    def busiest_per_year(self) -> float:
        """The most switches of one valve in a year, over all machines; NaN where none is known."""
        known = [each for each in map(self.per_year, self.cases) if np.isfinite(each)]
        return max(known, default=float("nan"))

    def worst_per_mass(self) -> tuple[CaseResult, ...]:
        """Return for each mass the first case that is not stable, or that with the worst index."""
        return worst_per_mass(self.cases)
