"""Gains on the nonlinear machine, judged with the linear models beside it, stored and drawn."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mptune.files import make_folder, write_whole
from mptune.job.gains import gains_file, with_gains
from mptune.job.report import draw_machine
from mptune.params.gains import accept_margins, write_gains
from mptune.progress import silent
from mptune.robust.chain import chain
from mptune.robust.headline import judge
from mptune.robust.sweep import sweep
from mptune.sim.sampled import linear_moves
from mptune.verify.checks import machine_checks
from mptune.verify.gain_limit import machine_reserve
from mptune.verify.store import write_traces
from mptune.verify.verify import verify

if TYPE_CHECKING:
    from mptune.params.judged_on import Difference
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.robust.chain import Link
    from mptune.robust.headline import Judgement
    from mptune.verify.result import VerifyResult


@dataclass(frozen=True)
class VerifiedStudy:
    """Gains judged on every model, the nonlinear machine among them.

    Attributes
    ----------
    verified
        The machine.
    chain
        Every model's gain factor; the machine's, last, was searched no further than to the reserve.
    judgement
        The verdict.
    differs
        In what the model differs from the one that a gains file was made for.
    files
        What was written; with a gains file, its copy with this verdict.
    """

    verified: VerifyResult
    chain: tuple[Link, ...]
    judgement: Judgement
    differs: tuple[Difference, ...]
    files: tuple[Path, ...]

    def json(self) -> dict[str, Any]:
        """Return verdict, cases and chain."""
        return {
            **self.judgement.json(),
            **self.verified.json(),
            "chain": [link.json() for link in self.chain],
            "differs": [one.json() for one in self.differs],
        }


def verify_study(
    study: ResolvedStudy,
    gains: str | Path | None,
    out: str | Path,
    progress: Progress = silent,
    *,
    force: bool = False,
) -> VerifiedStudy:
    """Verify a gains file (the study's own gains where None) on the nonlinear machine.

    With a gains file, a copy with the verdict found here goes to ``gains-verified.toml``.

    Raises
    ------
    InputError
        If the file is of another controller, or its margins are not satisfied and ``force`` is
        False.
    """
    study, file, differs = with_gains(study, gains)
    if gains is not None and file is not None:
        accept_margins(gains, file, force=force)
    folder = make_folder(Path(out) / study.name)
    progress("verify", 0.0)
    verified = verify(study, progress=progress)
    progress("sweep", 0.0)
    swept = sweep(study)
    progress("chain", 0.0)
    links = (*chain(swept), machine_reserve(verified, progress))
    judgement = judge((*swept.checks, *machine_checks(verified)), links)
    files = [write_traces(folder / "traces.nc", verified)]
    if file is not None:
        moves = linear_moves(study)
        copy = gains_file(swept, file.feedforward, moves, verified, judgement)
        files.append(write_gains(folder / "gains-verified.toml", copy))
    progress("figures", 0.0)
    for name, svg in draw_machine(verified).items():
        files.append(write_whole(folder / f"{name}.svg", svg))
    return VerifiedStudy(verified, links, judgement, differs, tuple(files))
