"""What a whole run found and wrote."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from mptune.interop import Drawn
from mptune.strict import strict
from mptune.summary import Summarised
from mptune.verify.before_after import in_a_sentence

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from mptune.params.study import ResolvedStudy
    from mptune.robust.chain import Link
    from mptune.robust.headline import Judgement
    from mptune.robust.result import SweepResult
    from mptune.sim.sampled import LinearMove
    from mptune.tune.baselines import Baseline
    from mptune.tune.result import TuneResult
    from mptune.verify.before_after import Change
    from mptune.verify.beside import PapersFrame
    from mptune.verify.result import VerifyResult


@dataclass(frozen=True, repr=False)
class JobResult(Summarised, Drawn):
    """What a whole run found and wrote.

    Attributes
    ----------
    published
        The sweep of the study's own gains.
    tuned
        The tuner's result, with its own sweep.
    moves, moves_before
        The linear check with tuned and with the study's own gains.
    verified, verified_before
        The nonlinear machine under the exported and under the study's own gains, with the same
        seeds; None where a written requirement is not met or undecided, as nothing is to be gained.
    judgement
        How the tuned gains came out on every model that was run.
    changes
        What became better and what worse on the machine.
    chain
        How far the gain at F_ref may rise with the tuned gains; the nonlinear machine's link comes
        last, where it was run.
    compared
        P, PI and PID tuned alike; empty where not asked for.
    files
        What was written.
    left_out
        What stood in the folder for the report and could not be used, and why, in sentences.
    papers_frame
        What tuning in the paper's own frame alone comes to; None where not asked for or not run.
    """

    drawings: ClassVar[Mapping[str, str]] = {"gains": "mptune.figures.compare:compared_gains"}

    study: ResolvedStudy
    published: SweepResult
    tuned: TuneResult
    moves: tuple[LinearMove, ...]
    moves_before: tuple[LinearMove, ...]
    verified: VerifyResult | None
    verified_before: VerifyResult | None
    chain: tuple[Link, ...]
    judgement: Judgement
    changes: tuple[Change, ...] = ()
    compared: tuple[Baseline, ...] = ()
    files: tuple[Path, ...] = ()
    left_out: tuple[str, ...] = ()
    papers_frame: PapersFrame | None = None

    @property
    def satisfied(self) -> bool:
        """Whether the verdict is *met*."""
        return self.judgement.met

    @property
    def headline(self) -> str:
        """Study and verdict."""
        return f"Run of {self.study.name}: {self.judgement.word}, {len(self.files)} files"

    def _drawn_with(self, _drawing: str) -> tuple[Any, ...]:
        own = ("the study's own", self.published, self.moves_before)
        return ((own, ("tuned", self.tuned.sweep, self.moves)),)

    def json(self) -> dict[str, Any]:
        """Return the result in SI, units in the keys."""
        before = self.verified_before
        values = {
            **self.judgement.json(),
            "sweep": self.published.json(),
            "tune": {**self.tuned.json(), "sweep": self.tuned.sweep.json()},
            "linear_check": [case.json() for case in self.moves],
            "verify": self.verified.json() if self.verified else None,
            "verify_before": before.json() if before else None,
            "changes": [one.json() for one in self.changes],
            "summary": in_a_sentence(self.changes),
            "papers_frame": self.papers_frame.json() if self.papers_frame else None,
            "chain": [link.json() for link in self.chain],
            "satisfied": self.satisfied,
            "files": [str(path) for path in self.files],
            "left_out": list(self.left_out),
        }
        if self.compared:
            values["compared"] = [one.json() for one in self.compared]
        return strict(values)
