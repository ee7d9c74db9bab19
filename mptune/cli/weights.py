"""The command that searches the force controller's weights."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from mptune.cli.options import (
    OUT,
    JsonOption,
    OutOption,
    QuietOption,
    SchedulerOption,
    SetOption,
    StudyArgument,
    TimesOption,
    UncertaintyOption,
    WorkersOption,
    finish,
)


def weights(
    study: StudyArgument,
    trials: Annotated[
        int, typer.Option(metavar="N", min=1, help="Trials of the search, earlier ones included.")
    ] = 80,
    sets: Annotated[
        int, typer.Option(metavar="N", min=1, help="Movement sets per run; the first is left out.")
    ] = 3,
    sampler: Annotated[str, typer.Option(metavar="NAME", help="tpe or nsga2.")] = "tpe",
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Seed of the search.")] = 1,
    also: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME", help="Search sampling_period, tolerances, common_mode too; repeatable."
        ),
    ] = None,
    storage: Annotated[
        str, typer.Option(metavar="ADDRESS", help="Optuna's database; else weights.db in --out.")
    ] = "",
    workers: WorkersOption = None,
    scheduler: SchedulerOption = "",
    override: SetOption = None,
    uncertainty: UncertaintyOption = "",
    out: OutOption = OUT,
    json: JsonOption = False,
    quiet: QuietOption = False,
    _verbose: TimesOption = False,
) -> None:
    """Search the force controller's weights: the order of §5.4, then beyond it."""
    from mptune.cli import show, show_weights
    from mptune.cli.interrupt import interruptible
    from mptune.cli.study import load_study, with_warnings
    from mptune.job.weights import weights_study

    loaded = load_study(study, override or (), uncertainty)
    try:
        with interruptible() as check, show.progress(quiet=quiet) as bars:

            def report(stage: str, share: float) -> None:
                check()
                bars(stage, share)

            result, files = weights_study(
                loaded, out, report, storage=storage, trials=trials, sampler=sampler, seed=seed,
                also=also or (), sets=sets, count=workers, scheduler=scheduler,
            )  # fmt: skip
    except KeyboardInterrupt:
        sys.stderr.write("mptune: finished trials are kept; the same command goes on\n")
        raise
    if json:
        show.as_json(with_warnings(result.json(), loaded))
    else:
        show_weights.weights(result)
        show.files(files)
    finish(met=result.satisfied)
