"""The whole job: sweep, tune, export, verify before and after, report.

::

    <out>/<study>.pdf           the report
    <out>/<study>.html          the same for the browser
    <out>/<study>.png           its four panels, as a picture
    <out>/<study>/sweep.nc      both inequalities and margins, of the final gains
    <out>/<study>/gains.toml    the controller's gains, with verdicts
    <out>/<study>/traces.nc     the nonlinear machine's last movement set, per mass
    <out>/<study>/*.svg         the figures, the chain of gain factors among them

A run is not resumed: all that it finds follows from study and version, and takes about a minute.
Half of it is the tuner's search, whose result is more than ``gains.toml`` holds, the other half the
machine, whose traces are; kept beside, both would have to be bound to the program's every line.

With the comparison asked for, ``comparison.json`` and ``controllers.svg`` as well; the report shows
whatever other commands have left in the folder for the same model.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from mptune.claim import claimed
from mptune.files import make_folder, write_whole
from mptune.job.gains import gains_file
from mptune.job.own_machine import own_machine
from mptune.job.papers_frame import papers_frame
from mptune.job.report import draw_chain, draw_machine, linear_part, report, results_of
from mptune.job.result import JobResult
from mptune.job.tune import compared_files
from mptune.params.gains import read_gains, write_gains
from mptune.params.headline import Headline
from mptune.progress import silent
from mptune.robust.chain import chain, other_reading
from mptune.robust.headline import judge
from mptune.robust.store import write_sweep
from mptune.robust.sweep import sweep, with_radii
from mptune.sim.sampled import linear_moves
from mptune.tune.baselines import baselines
from mptune.tune.papers_frame import has_papers_frame, in_papers_frame
from mptune.tune.tuner import tune
from mptune.verify.before_after import changes
from mptune.verify.checks import machine_checks
from mptune.verify.gain_limit import as_verified, machine_gain_limit
from mptune.verify.store import write_traces
from mptune.verify.verify import verify

if TYPE_CHECKING:
    from concurrent.futures import Future

    from mptune.job.own_machine import OwnMachine
    from mptune.job.report import LinearPart
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.tune.result import TuneResult
    from mptune.verify.result import VerifyResult

STAGES = (
    *("sweep", "tune", "linear check", "chain", "verify own", "verify"),
    *("paper's frame", "compare", "figures", "report"),
)
_WORTH_RUNNING = {Headline.MET, Headline.ON_PAPER}


class SideWork(NamedTuple):
    """What is made in one thread beside the machine: drawn, and tuned for comparison.

    It runs the kernels that have threads of their own and must not run twice at once; the
    simulation runs none of them.
    """

    linear: Future[LinearPart]
    in_frame: Future[TuneResult] | None = None
    machine: Future[dict[str, bytes]] | None = None


def run(
    study: ResolvedStudy,
    out: str | Path,
    progress: Progress = silent,
    *,
    compare: bool = False,
) -> JobResult:
    """Run the whole job: sweep, tune, export, verify on the nonlinear machine, report.

    On the machine the tuned gains stand beside the study's own, with the same seeds.

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
    with (
        claimed(folder, "run", "a run of the whole job"),
        ThreadPoolExecutor(1, "beside") as thread,
    ):
        result, beside = _judged(study, folder, progress, thread)
        if compare:
            progress("compare", 0.0)
            beside.linear.result()
            compared = baselines(study, result.tuned, progress)
            more = compared_files(folder, study, compared)
            result = replace(result, compared=compared, files=(*result.files, *more))
        progress("figures", 0.0)
        return _handed_over(result, beside, out, folder, progress)


def _handed_over(
    result: JobResult, beside: SideWork, out: Path, folder: Path, progress: Progress
) -> JobResult:
    """Draw what is not drawn yet of a result, write its report, and name all that was written."""
    linear = beside.linear.result()
    of_machine = beside.machine.result() if beside.machine else {}
    figures = {**linear.figures, **draw_chain(result.chain), **of_machine}
    files = [*result.files]
    files += [write_whole(folder / f"{name}.svg", svg) for name, svg in figures.items()]
    files.append(write_whole(out / f"{result.study.name}.png", linear.picture))
    progress("report", 0.0)
    results = results_of(out, result, linear)
    files += report(out, results, figures)
    progress("report", 1.0)
    return replace(result, files=tuple(files), left_out=results.leftovers.left_out)


def _judged(
    study: ResolvedStudy, folder: Path, progress: Progress, thread: ThreadPoolExecutor
) -> tuple[JobResult, SideWork]:
    """Tune, judge on every model, and write sweep, gains and traces.

    The machine runs under the study's own gains meanwhile. What is known before it runs under those
    found is drawn beside it.
    """
    with own_machine(study) as own:
        progress("sweep", 0.0)
        published = sweep(study)
        progress("tune", 0.0)
        tuned = tune(study, progress)
        tuned = replace(tuned, sweep=with_radii(tuned.sweep))
        progress("linear check", 0.0)
        moves_before = linear_moves(study)
        moves = linear_moves(tuned.sweep.study, tuned.gains, tuned.feedforward)
        progress("chain", 0.0)
        links, lumped = chain(tuned.sweep), other_reading(tuned.sweep)
        judgement = judge(tuned.sweep.checks, links)
        linear = gains_file(tuned.sweep, tuned.feedforward, moves, None, judgement)
        exported = write_gains(folder / "gains.toml", linear)
        files = [write_sweep(folder / "sweep.nc", tuned.sweep), exported]
        beside = SideWork(thread.submit(linear_part, tuned.sweep, moves))
        verified = before = frame = None
        if judgement.word in _WORTH_RUNNING:
            if has_papers_frame(study):
                beside = beside._replace(in_frame=thread.submit(tune, in_papers_frame(study)))
            verified, before = _verified(study, exported, own, progress)
            beside = beside._replace(machine=thread.submit(draw_machine, verified))
    if before is not None and beside.in_frame is not None:
        frame = papers_frame(study, before, beside.in_frame.result, progress)
    if verified is not None:
        progress("chain", 0.0)
        links = (*links, as_verified(machine_gain_limit(verified, progress), verified))
        judgement = judge((*tuned.sweep.checks, *machine_checks(verified)), links)
        whole = gains_file(tuned.sweep, tuned.feedforward, moves, verified, judgement)
        write_gains(exported, whole)
        files.append(write_traces(folder / "traces.nc", verified))
    result = JobResult(
        study=study,
        published=published,
        tuned=tuned,
        moves=moves,
        moves_before=moves_before,
        verified=verified,
        verified_before=before,
        chain=(*links, *lumped),
        judgement=judgement,
        changes=changes(before, verified) if before and verified else (),
        papers_frame=frame,
        files=tuple(files),
    )
    return result, beside


def _verified(
    study: ResolvedStudy, exported: Path, own: OwnMachine, progress: Progress
) -> tuple[VerifyResult, VerifyResult]:
    """Return the machine under exported gains, and under the study's own, which run only once."""
    file = read_gains(exported, study.hash())
    progress("verify own", 0.0)
    before = own.result(progress)
    held = study.study
    if all(getattr(held, name) == section for name, section in file.chosen.items()):
        return before, before
    progress("verify", 0.0)
    return verify(file.put_over(study), progress=progress), before
