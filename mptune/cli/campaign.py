"""The command that makes many simulations."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from mptune.cli.options import (
    OUT,
    ForceOption,
    GainsOption,
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

if TYPE_CHECKING:
    from pathlib import Path

    from mptune.campaign.plan import Plan
    from mptune.params.judged_on import Difference

    _Made = tuple[Plan, tuple[Difference, ...]]  # a campaign, and how its model differs


def campaign(
    study: StudyArgument,
    gains: GainsOption = None,
    force: ForceOption = False,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = "",
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with an interrupted campaign.")
    ] = False,
    replay: Annotated[
        int | None, typer.Option(metavar="RUN", help="Make one run again, exactly, and draw it.")
    ] = None,
    worst: Annotated[
        str, typer.Option(metavar="FIGURE", help="Search the ranges for the worst machine.")
    ] = "",
    runs_for: Annotated[
        tuple[float, float] | None,
        typer.Option(
            metavar="EPSILON DELTA",
            help="Say how many runs guarantee a failure probability below EPSILON with a "
            "confidence of 1 - DELTA; run nothing.",
        ),
    ] = None,
    override: SetOption = None,
    uncertainty: UncertaintyOption = "",
    out: OutOption = OUT,
    json: JsonOption = False,
    quiet: QuietOption = False,
    _verbose: TimesOption = False,
) -> None:
    """Simulate many machines; conclude distributions, worst cases and guarantees."""
    from mptune.cli.show_campaign import needed
    from mptune.cli.study import load_study
    from mptune.job.campaign import planned

    _check_one_task({"--replay": replay, "--worst": worst or None, "--runs-for": runs_for})
    if runs_for is not None:
        needed(*runs_for, json=json)
        return
    made = planned(load_study(study, override or (), uncertainty), gains, force=force)
    if replay is not None:
        _replay(made, replay, out, json=json)
    team = {"count": workers, "scheduler": scheduler}
    if worst:
        _worst(made, worst, out, team, json=json, quiet=quiet)
    _campaign(made, out, team, resume=resume, json=json, quiet=quiet)


def _check_one_task(tasks: dict[str, object]) -> None:
    from mptune.errors import Fault, InputError

    asked = [option for option, value in tasks.items() if value is not None]
    if len(asked) > 1:
        fault = Fault("", " and ".join(asked), "are tasks of their own", "ask for one at a time")
        raise InputError("mptune campaign", fault)


def _with(differs: tuple[Difference, ...], values: dict[str, Any]) -> dict[str, Any]:
    return {**values, "differs": [one.json() for one in differs]}


def _replay(made: _Made, number: int, out: Path, *, json: bool) -> NoReturn:
    from mptune.cli import show, show_campaign
    from mptune.job.campaign import replay_run

    plan, differs = made
    case, reason, files = replay_run(plan, number, out)
    if json:
        show.as_json(_with(differs, show_campaign.replay_json(plan, number, case, reason)))
    else:
        show.elsewhere(differs)
        show_campaign.replayed(plan, number, case, reason)
        show.files(files)
    finish(met=not reason)


def _worst(
    made: _Made, figure: str, out: Path, team: dict[str, Any], *, json: bool, quiet: bool
) -> NoReturn:
    from mptune.cli import show, show_campaign
    from mptune.cli.study import with_warnings
    from mptune.job.campaign import worst_machine

    plan, differs = made
    with show.progress(quiet=quiet) as report:
        found, files = worst_machine(plan, figure, out, report, **team)
    if json:
        show.as_json(with_warnings(_with(differs, found.json()), plan.study))
    else:
        show.elsewhere(differs)
        show_campaign.worst(found)
        show.files(files)
    finish(met=not found.reason)


def _campaign(
    made: _Made, out: Path, team: dict[str, Any], *, resume: bool, json: bool, quiet: bool
) -> NoReturn:
    from mptune.cli import show, show_campaign
    from mptune.cli.study import with_warnings
    from mptune.job.campaign import campaign_study

    plan, differs = made
    try:
        with show_campaign.progress(plan.runs, quiet=quiet) as report:
            result, files = campaign_study(plan, out, report, resume=resume, **team)
    except KeyboardInterrupt:
        sys.stderr.write("mptune: finished chunks are kept; go on with --resume\n")
        raise
    if json:
        show.as_json(with_warnings(_with(differs, result.json()), plan.study))
    else:
        show.elsewhere(differs)
        show_campaign.campaign(result)
        show.files(files)
    finish(met=result.satisfied)
