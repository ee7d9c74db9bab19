"""Simpler controllers under the same requirements and objective, beside the published gains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from mptune.interop import Drawn
from mptune.progress import silent
from mptune.robust.sweep import sweep
from mptune.strict import strict
from mptune.summary import Summarised
from mptune.tune.tuner import Tuner

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mptune.params.controller import Gains
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.robust.result import SweepResult
    from mptune.tune.objective import Figures
    from mptune.tune.result import TuneResult, TuneStatus

SIMPLER = ("p", "pi", "pid")
LABELS = {
    "own": "the study's own gains",
    "p": "P",
    "pi": "PI",
    "pid": "PID with filter",
    "eq22": "Eq. 22",
}


@dataclass(frozen=True, repr=False)
class Baseline(Summarised, Drawn):
    """One controller of the comparison.

    Attributes
    ----------
    name
        A key of ``LABELS``.
    status
        Of its tuning; None for the study's own gains, which are not tuned.
    """

    drawings: ClassVar[Mapping[str, str]] = {"panels": "mptune.figures.panels:four_panels"}

    name: str
    status: TuneStatus | None
    gains: Gains
    figures: Figures
    sweep: SweepResult

    @property
    def headline(self) -> str:
        """The controller, its status and index."""
        status = self.status or "not tuned"
        return f"{LABELS[self.name]}: {status}, index {1e3 * self.figures.tracking:.4g} ms"

    def _drawn_with(self, _drawing: str) -> tuple[Any, ...]:
        return (self.sweep,)

    def json(self) -> dict[str, Any]:
        """Return the controller in SI, units in the keys."""
        values = {
            "structure": self.name,
            "status": self.status.value if self.status else None,
            "gains": self.gains.model_dump(),
            "satisfied": self.sweep.satisfied,
            "velocity_worst_ratio": self.sweep.velocity.worst_ratio,
            "position_worst_ratio": self.sweep.position.worst_ratio,
            "figures": self.figures.json(),
        }
        return strict(values)


def baselines(
    study: ResolvedStudy,
    tuned: TuneResult,
    progress: Progress = silent,
) -> tuple[Baseline, ...]:
    """Return the study's own gains, P, PI and PID tuned alike, and the tuned gains.

    Bounds of gains that a structure does not have are not asked of it.

    Parameters
    ----------
    study
        The study.
    tuned
        Its tuning, which the others stand beside.
    progress
        Told of the stage ``"compare"``.
    """
    own = Baseline("own", None, tuned.before, tuned.figures_before, sweep(study))
    rows, tuner = [own], Tuner(study)
    for n, name in enumerate(SIMPLER):
        progress("compare", n / len(SIMPLER))
        rows.append(_row(tuner.tuned(name)))
    rows.append(_row(tuned))
    progress("compare", 1.0)
    return tuple(rows)


def _row(result: TuneResult) -> Baseline:
    return Baseline(result.structure, result.status, result.gains, result.figures, result.sweep)
