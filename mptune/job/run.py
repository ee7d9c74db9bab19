"""The whole job: sweep, tune, export, verify, report.

::

    <out>/<study>.pdf           the report
    <out>/<study>.html          the same for the browser
    <out>/<study>.png           its four panels, as a picture
    <out>/<study>/sweep.nc      both inequalities and margins, of the final gains
    <out>/<study>/gains.toml    the controller's gains, with verdicts
    <out>/<study>/traces.nc     the nonlinear machine's last movement set, per mass
    <out>/<study>/*.svg         the figures, the chain of gain factors among them

With the comparison asked for, ``comparison.json`` and ``controllers.svg`` as well; the report shows
whatever other commands have left in the folder for the same model.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from mptune.claim import claimed
from mptune.files import make_folder, write_whole
from mptune.job.gains import gains_file
from mptune.job.report import draw, report
from mptune.job.result import JobResult
from mptune.job.tune import compared_files
from mptune.params.gains import read_gains, write_gains
from mptune.progress import silent
from mptune.robust.chain import chain, other_reading
from mptune.robust.encirclements import encirclements
from mptune.robust.store import write_sweep
from mptune.robust.sweep import sweep, with_radii
from mptune.sim.sampled import linear_moves
from mptune.tune.baselines import Baseline, baselines
from mptune.tune.tuner import tune
from mptune.verify.gain_limit import machine_gain_limit
from mptune.verify.precompile import precompiling
from mptune.verify.store import write_traces
from mptune.verify.verify import verify

if TYPE_CHECKING:
    from mptune.params.controller import Feedforward
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.robust.chain import Link
    from mptune.robust.result import SweepResult
    from mptune.verify.result import VerifyResult

STAGES = ("sweep", "tune", "linear check", "verify", "chain", "compare", "figures", "report")


def run(
    study: ResolvedStudy,
    out: str | Path,
    progress: Progress = silent,
    *,
    compare: bool = False,
) -> JobResult:
    """Run the whole job: sweep, tune, export, verify on the nonlinear machine, report.

    Parameters
    ----------
    study
        The study.
    out
        Folder for the results; created where missing.
    progress
        Called with a stage of ``STAGES`` and the share of it that is done.
    compare
        Whether to tune P, PI and PID as well, which takes three to five times the tuning's time.

    Raises
    ------
    InputError
        If another process does the same job in the same folder.
    OutputError
        If results cannot be written.
    """
    out = Path(out)
    folder = make_folder(out / study.name)
    with claimed(folder, "run", "a run of the whole job"):
        return _run(study, out, folder, progress, compare=compare)


def _run(
    study: ResolvedStudy, out: Path, folder: Path, progress: Progress, *, compare: bool
) -> JobResult:
    with precompiling() as simulator_ready:
        progress("sweep", 0.0)
        published = sweep(study)
        progress("tune", 0.0)
        tuned = tune(study, progress)
        tuned = replace(tuned, sweep=with_radii(tuned.sweep))
        progress("linear check", 0.0)
        moves_before = linear_moves(study)
        moves = linear_moves(study, tuned.gains, tuned.feedforward)
        if tuned.sweep.satisfied:
            simulator_ready()
    exported = write_gains(
        folder / "gains.toml", gains_file(tuned.sweep, tuned.feedforward, moves, None)
    )
    files = [write_sweep(folder / "sweep.nc", tuned.sweep), exported]
    verified = None
    if tuned.sweep.satisfied:
        progress("verify", 0.0)
        file = read_gains(exported, study.hash())
        verified = verify(study, file.gains, file.feedforward, progress)
        write_gains(exported, gains_file(tuned.sweep, tuned.feedforward, moves, verified))
        files.append(write_traces(folder / "traces.nc", verified))
    links = gain_factors(tuned.sweep, tuned.feedforward, verified, progress)
    compared: tuple[Baseline, ...] = ()
    if compare:
        progress("compare", 0.0)
        compared = baselines(study, tuned, progress)
        files += compared_files(folder, study, compared)
    result = JobResult(study, published, tuned, moves, moves_before, verified, links, compared)
    progress("figures", 0.0)
    counts = encirclements(tuned.sweep)
    figures, picture = draw(result, counts)
    files += [write_whole(folder / f"{name}.svg", svg) for name, svg in figures.items()]
    files.append(write_whole(out / f"{study.name}.png", picture))
    progress("report", 0.0)
    files += report(out, result, counts, figures)
    progress("report", 1.0)
    return replace(result, files=tuple(files))


def gain_factors(
    swept: SweepResult,
    feedforward: Feedforward,
    verified: VerifyResult | None,
    progress: Progress,
) -> tuple[Link, ...]:
    """Return the chain of the swept gains, with the nonlinear machine where it was verified.

    The other reading of the delays comes last.
    """
    progress("chain", 0.0)
    links, other = chain(swept), other_reading(swept)
    if verified is None:
        return (*links, *other)
    machine = machine_gain_limit(swept.study, swept.gains, feedforward, progress)
    return (*links, machine, *other)
