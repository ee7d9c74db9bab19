"""``mptune tune``: gains that satisfy the requirements and perform best within them."""

from __future__ import annotations

from typing import Annotated

import typer

from mptune.cli.options import (
    OUT,
    JsonOption,
    OutOption,
    QuietOption,
    SetOption,
    StudyArgument,
    TimesOption,
    UncertaintyOption,
    finish,
)


def tune(
    study: StudyArgument,
    structure: Annotated[
        str, typer.Option(metavar="NAME", help="Position controller: eq22, p, pi or pid.")
    ] = "eq22",
    compare: Annotated[
        bool, typer.Option("--compare", help="Tune P, PI and PID alike and compare.")
    ] = False,
    front: Annotated[
        int,
        typer.Option(min=0, max=50, metavar="N", help="Points of a front of tracking."),
    ] = 0,
    along: Annotated[
        str, typer.Option(metavar="NAME", help="What it runs along: k_i_pos or disk_margin.")
    ] = "k_i_pos",
    override: SetOption = None,
    uncertainty: UncertaintyOption = "",
    out: OutOption = OUT,
    json: JsonOption = False,
    quiet: QuietOption = False,
    _verbose: TimesOption = False,
) -> None:
    """Find gains that satisfy the requirements."""
    from mptune.cli import show
    from mptune.cli.show_tune import whole_tuning
    from mptune.cli.study import load_study, with_warnings
    from mptune.job.tune import tune_study

    loaded = load_study(study, override or (), uncertainty)
    with show.progress(quiet=quiet) as report:
        result = tune_study(
            loaded, out, report, structure=structure, compare=compare, points=front, along=along
        )
    if json:
        show.as_json(with_warnings(result.json(), loaded))
    else:
        show.headline(result.judgement)
        whole_tuning(result)
    finish(met=result.judgement.met)
