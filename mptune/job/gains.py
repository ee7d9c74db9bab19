"""What ``gains.toml`` says of a set of gains."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.errors import Fault, InputError
from mptune.params.gains import GainsFile, Verdict, now, read_gains, version

if TYPE_CHECKING:
    from pathlib import Path

    from mptune.params.study import ResolvedStudy
    from mptune.robust.result import SweepResult
    from mptune.sim.sampled import LinearMove
    from mptune.verify.result import VerifyResult


def gains_file(
    swept: SweepResult, moves: tuple[LinearMove, ...], verified: VerifyResult | None
) -> GainsFile:
    """Return what ``gains.toml`` says of a set of gains and its verdicts.

    The closed loop's verdict is the nonlinear machine's; "not run" where that has not been run.
    """
    margins: Verdict = "satisfied" if swept.satisfied else "violated"
    closed_loop: Verdict = "not run"
    if verified is not None:
        closed_loop = "satisfied" if verified.satisfied else "violated"
    worst = {f"{condition.name}_ratio": condition.worst_ratio for condition in swept.conditions}
    index = {
        f"linear_index_ms_{case.mass_kg:.0f}_kg": case.performance_index_ms
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
        margins=margins,
        closed_loop=closed_loop,
        gains=swept.gains,
        feedforward=swept.study.study.feedforward,
        figures={"margins": worst, "closed_loop": index},
    )


def accepted_gains(study: ResolvedStudy, path: Path | None, *, force: bool) -> GainsFile | None:
    """Return what a gains file says; None where none is given and the study's own are meant.

    Raises
    ------
    InputError
        If the file is not for this study, or its margins are not satisfied and ``force`` is False.
    """
    file = read_gains(path, study.hash()) if path else None
    if file is not None and file.margins != "satisfied" and not force:
        fault = Fault(
            "margins",
            file.margins,
            "is no verdict that the controller accepts",
            "tune again, or insist with --force",
        )
        raise InputError(path, fault)
    return file
