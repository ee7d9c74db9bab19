"""What ``gains.toml`` says of a set of gains."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.params.gains import GainsFile, Verdict, gains_for, now, version
from mptune.params.judged_on import judged_on
from mptune.robust.headline import judge_sweep

if TYPE_CHECKING:
    from pathlib import Path

    from mptune.params.controller import Feedforward
    from mptune.params.judged_on import Difference
    from mptune.params.study import ResolvedStudy
    from mptune.robust.headline import Judgement
    from mptune.robust.result import SweepResult
    from mptune.sim.sampled import LinearMove
    from mptune.verify.result import VerifyResult


def with_gains(
    study: ResolvedStudy, gains: str | Path | None
) -> tuple[ResolvedStudy, GainsFile | None, tuple[Difference, ...]]:
    """Return a study with what a gains file says in its place, the file, and what differs.

    The study as it is, None and nothing where no file is named.

    Raises
    ------
    InputError
        If the file cannot be read, or is of another controller.
    """
    if gains is None:
        return study, None, ()
    file, differs = gains_for(study, gains)
    return file.put_over(study), file, differs


def gains_file(
    swept: SweepResult,
    feedforward: Feedforward,
    moves: tuple[LinearMove, ...],
    verified: VerifyResult | None,
    judgement: Judgement | None = None,
) -> GainsFile:
    """Return what ``gains.toml`` says of a set of gains and its verdicts.

    The closed loop's verdict is the nonlinear machine's; "not run" where that has not been run. The
    margins are satisfied only where the ``judgement`` is *met*; where None, it is made of the
    linear models.
    """
    judgement = judgement or judge_sweep(swept)
    margins: Verdict = "satisfied" if judgement.met else "violated"
    closed_loop: Verdict = "not run"
    if verified is not None:
        closed_loop = "satisfied" if verified.satisfied else "violated"
    worst = {f"{condition.name}_ratio": condition.worst_ratio for condition in swept.conditions}
    index = {
        f"linear_check_index_ms_{case.mass_kg:.0f}_kg": case.performance_index_ms
        for case in moves
        if case.stable
    }
    for case in verified.worst_per_mass() if verified else ():
        index[f"index_ms_{case.mass_kg:.0f}_kg"] = case.mean("performance_index_ms")
        index[f"loss_j_per_mm_{case.mass_kg:.0f}_kg"] = case.mean("energy_loss_j_per_mm")
    return GainsFile(
        study=swept.study.name,
        study_hash=swept.study.hash(),
        uncertainty=swept.study.uncertainty_name,
        version=version(),
        date=now(),
        verdict=judgement.word,
        reason=judgement.because,
        margins=margins,
        closed_loop=closed_loop,
        gains=swept.gains,
        feedforward=feedforward,
        estimator=swept.study.study.estimator,
        figures={"margins": worst, "closed_loop": index},
        judged_on=judged_on(swept.study),
    )
