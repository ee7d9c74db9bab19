"""``mptune run``: the whole job, from the study file to gains and report."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from mptune.cli.options import (
    OUT,
    JsonOption,
    OutOption,
    SetOption,
    StudyArgument,
    UncertaintyOption,
    VerboseOption,
    finish,
)

if TYPE_CHECKING:
    from mptune.job.result import JobResult


def run(
    study: StudyArgument,
    compare: Annotated[
        bool, typer.Option("--compare", help="Tune P, PI and PID alike for the report.")
    ] = False,
    override: SetOption = None,
    uncertainty: UncertaintyOption = "",
    out: OutOption = OUT,
    json: JsonOption = False,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="No progress, and the first line only.")
    ] = False,
    verbose: VerboseOption = False,
) -> None:
    """Do the whole job, from the study file to gains and report."""
    from mptune.cli import show
    from mptune.cli.study import load_study, with_warnings
    from mptune.job.run import run as run_job

    loaded = load_study(study, override or (), uncertainty)
    with show.progress(quiet=quiet) as report:
        result = run_job(loaded, out, report, compare=compare)
    if json:
        show.as_json(with_warnings(result.json(), loaded))
    else:
        _say(result, quiet=quiet, verbose=verbose)
    finish(met=result.satisfied)


def _say(result: JobResult, *, quiet: bool, verbose: bool) -> None:
    from mptune.cli import show, show_run, show_tune

    show.headline(result.judgement)
    if verbose:
        show_tune.tuned(result.tuned)
        show_run.details(result)
        show.files(result.files)
    elif not quiet:
        show_run.summary(result)
