"""Gains on the nonlinear machine, stored and drawn."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mptune.files import make_folder, write_whole
from mptune.params.gains import accepted_gains
from mptune.progress import silent
from mptune.report.content.closed_loop import machine_figure
from mptune.verify.store import write_traces
from mptune.verify.verify import verify

if TYPE_CHECKING:
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.verify.result import VerifyResult


def verify_study(
    study: ResolvedStudy,
    gains: str | Path | None,
    out: str | Path,
    progress: Progress = silent,
    *,
    force: bool = False,
) -> tuple[VerifyResult, tuple[Path, ...]]:
    """Verify a gains file (the study's own gains where None) on the nonlinear machine.

    Raises
    ------
    InputError
        If the file is not for this study, or its margins are not satisfied and ``force`` is False.
    """
    from mptune.figures.machine import machine_traces
    from mptune.figures.style import to_svg

    file = accepted_gains(gains, study.hash(), force=force) if gains else None
    folder = make_folder(Path(out) / study.name)
    progress("verify", 0.0)
    verified = verify(
        study,
        file.gains if file else None,
        file.feedforward if file else None,
        progress,
    )
    progress("figures", 0.0)
    files = [write_traces(folder / "traces.nc", verified)]
    for case in verified.worst_per_mass():
        svg = to_svg(machine_traces(case))
        files.append(write_whole(folder / f"{machine_figure(case.mass_kg)}.svg", svg))
    return verified, tuple(files)
