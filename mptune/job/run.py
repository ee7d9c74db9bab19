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
from typing import TYPE_CHECKING

from mptune.claim import claimed
from mptune.files import make_folder, write_whole
from mptune.job.gains import gains_file
from mptune.job.papers_frame import papers_frame
from mptune.job.report import draw, linear_part, report, results_of
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
from mptune.tune.tuner import tune
from mptune.verify.before_after import changes
from mptune.verify.checks import machine_checks
from mptune.verify.gain_limit import as_verified, machine_gain_limit
from mptune.verify.precompile import precompiling
from mptune.verify.store import write_traces
from mptune.verify.verify import verify

if TYPE_CHECKING:
    from concurrent.futures import Future

    from mptune.job.report import LinearPart
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.verify.result import VerifyResult

STAGES = (
    *("sweep", "tune", "linear check", "chain", "verify", "verify own"),
    *("paper's frame", "compare", "figures", "report"),
)
_WORTH_RUNNING = {Headline.MET, Headline.ON_PAPER}


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
        ThreadPoolExecutor(1, "drawing") as drawing,
    ):
        result, linear = _judged(study, folder, progress, drawing)
        if compare:
            progress("compare", 0.0)
            compared = baselines(study, result.tuned, progress)
            more = compared_files(folder, study, compared)
            result = replace(result, compared=compared, files=(*result.files, *more))
        progress("figures", 0.0)
        return _handed_over(result, linear.result(), out, folder, progress)


def _handed_over(
    result: JobResult, linear: LinearPart, out: Path, folder: Path, progress: Progress
) -> JobResult:
    """Draw what is not drawn yet of a result, write its report, and name all that was written."""
    figures = draw(result, linear)
    files = [*result.files]
    files += [write_whole(folder / f"{name}.svg", svg) for name, svg in figures.items()]
    files.append(write_whole(out / f"{result.study.name}.png", linear.picture))
    progress("report", 0.0)
    results = results_of(out, result, linear)
    files += report(out, results, figures)
    progress("report", 1.0)
    return replace(result, files=tuple(files), left_out=results.leftovers.left_out)


def _judged(
    study: ResolvedStudy, folder: Path, progress: Progress, drawing: ThreadPoolExecutor
) -> tuple[JobResult, Future[LinearPart]]:
    """Tune, judge on every model, and write sweep, gains and traces.

    What is known before the machine runs is drawn beside it.
    """
    with precompiling() as simulator_ready:
        progress("sweep", 0.0)
        published = sweep(study)
        progress("tune", 0.0)
        tuned = tune(study, progress)
        tuned = replace(tuned, sweep=with_radii(tuned.sweep))
        progress("linear check", 0.0)
        moves_before = linear_moves(study)
        moves = linear_moves(tuned.sweep.study, tuned.gains, tuned.feedforward)
        progress("chain", 0.0)
        links = chain(tuned.sweep)
        judgement = judge(tuned.sweep.checks, links)
        runs = judgement.word in _WORTH_RUNNING
        if runs:
            simulator_ready()
    linear = gains_file(tuned.sweep, tuned.feedforward, moves, None, judgement)
    exported = write_gains(folder / "gains.toml", linear)
    files = [write_sweep(folder / "sweep.nc", tuned.sweep), exported]
    lumped = other_reading(tuned.sweep)
    linear_drawn = drawing.submit(linear_part, tuned.sweep, moves)
    verified, before = _verified(study, exported, progress) if runs else (None, None)
    frame = None
    if before is not None and study.study.verification.papers_frame:
        frame = papers_frame(study, before, progress)
    if verified is not None:
        progress("chain", 0.0)
        machine = machine_gain_limit(
            tuned.sweep.study, verified.gains, verified.feedforward, progress
        )
        links = (*links, as_verified(machine, verified))
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
    return result, linear_drawn


def _verified(
    study: ResolvedStudy, exported: Path, progress: Progress
) -> tuple[VerifyResult, VerifyResult]:
    """Return the machine under exported gains, and under the study's own, which run only once."""
    file = read_gains(exported, study.hash())
    progress("verify", 0.0)
    verified = verify(file.put_over(study), progress=progress)
    own = study.study
    if all(getattr(own, name) == section for name, section in file.chosen.items()):
        return verified, verified
    progress("verify own", 0.0)
    return verified, verify(study, progress=lambda _, share: progress("verify own", share))
