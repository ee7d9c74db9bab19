"""What a whole run found and wrote."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

    from mptune.params.study import ResolvedStudy
    from mptune.robust.chain import Link
    from mptune.robust.result import SweepResult
    from mptune.sim.sampled import LinearMove
    from mptune.tune.baselines import Baseline
    from mptune.tune.result import TuneResult
    from mptune.verify.result import VerifyResult


@dataclass(frozen=True)
class JobResult:
    """What a whole run found and wrote.

    Attributes
    ----------
    published
        The sweep of the study's own gains.
    tuned
        The tuner's result, with its own sweep.
    moves, moves_before
        The linear check with tuned and with the study's own gains.
    verified
        The nonlinear machine under the exported gains; None where their margins are not satisfied,
        as the controller then refuses them.
    chain
        How far the gain at F_ref may rise with the tuned gains; the nonlinear machine's link comes
        last, where it was run.
    compared
        P, PI and PID tuned alike; empty where not asked for.
    files
        What was written.
    """

    study: ResolvedStudy
    published: SweepResult
    tuned: TuneResult
    moves: tuple[LinearMove, ...]
    moves_before: tuple[LinearMove, ...]
    verified: VerifyResult | None
    chain: tuple[Link, ...]
    compared: tuple[Baseline, ...] = ()
    files: tuple[Path, ...] = ()

    @property
    def satisfied(self) -> bool:
        """Whether every requirement is met and every machine verified as stable."""
        verified = self.verified is not None and self.verified.satisfied
        return self.tuned.sweep.satisfied and verified

    def json(self) -> dict[str, Any]:
        """Return the result in SI, units in the keys."""
        values = {
            "sweep": self.published.json(),
            "tune": {**self.tuned.json(), "sweep": self.tuned.sweep.json()},
            "linear_check": [moves_json(case) for case in self.moves],
            "verify": self.verified.json() if self.verified else None,
            "chain": [link.json() for link in self.chain],
            "satisfied": self.satisfied,
            "files": [str(path) for path in self.files],
        }
        if self.compared:
            values["compared"] = [one.json() for one in self.compared]
        return values


def moves_json(case: LinearMove) -> dict[str, Any]:
    """Return one case of the linear check; the index keeps §7's unit."""
    return {
        "mass_kg": case.mass_kg,
        "valve_delay_s": case.valve_delay_s,
        "oil_bulk_modulus_pa": case.oil_bulk_modulus_pa,
        "stable": case.stable,
        "performance_index_ms": case.performance_index_ms,
    }
