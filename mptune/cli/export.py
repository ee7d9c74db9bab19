"""``mptune export``: the controller's files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from mptune.cli.options import (
    OUT,
    JsonOption,
    OutOption,
    QuietOption,
    SetOption,
    TimesOption,
    a_path,
    finish,
)
from mptune.export.formats import Precision, Target

GainsArgument = Annotated[
    Path, typer.Argument(parser=a_path, metavar="GAINS", help="The gains file.")
]
StudyOption = Annotated[
    Path | None,
    typer.Option(
        parser=a_path,
        metavar="FILE",
        help="The study of the machine, with the controller that the gains were made for; else "
        "studies/NAME/study.toml, beside the gains, here or above.",
    ),
]
ToOption = Annotated[
    Target, typer.Option(help="fmu: FMI 2.0 and 3.0; st: IEC 61131-3, all but the decision.")
]
PrecisionOption = Annotated[Precision, typer.Option(help="Arithmetic of the target.")]
DigitsOption = Annotated[
    int | None,
    typer.Option(min=1, max=17, metavar="N", help="Round the gains to N significant digits."),
]
ForceOption = Annotated[
    bool, typer.Option("--force", help="Take gains whose margins are not satisfied.")
]


def export(
    gains: GainsArgument,
    to: ToOption,
    study: StudyOption = None,
    precision: PrecisionOption = Precision.DOUBLE,
    digits: DigitsOption = None,
    force: ForceOption = False,
    override: SetOption = None,
    out: OutOption = OUT,
    json: JsonOption = False,
    quiet: QuietOption = False,
    _verbose: TimesOption = False,
) -> None:
    """Write the controller for a target, its margins computed as written."""
    from mptune.cli import show
    from mptune.cli.show_export import exported
    from mptune.job.export import export as export_job

    with show.progress(quiet=quiet) as report:
        result = export_job(
            gains,
            to,
            out,
            study=study,
            overrides=override or (),
            precision=precision,
            digits=digits,
            force=force,
            progress=report,
        )
    if json:
        show.as_json(result.json())
    else:
        exported(result)
    finish(met=result.satisfied)
