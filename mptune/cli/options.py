"""Options and endings that the commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, NoReturn

import typer

from mptune.cli.stages import be_verbose

_NOT_MET = 1


def a_path(text: str | Path) -> Path:
    """Return the path that an option or argument names.

    Raises
    ------
    InputError
        If it is empty, which would mean the current folder.
    """
    if not str(text):
        from mptune.errors import Fault, InputError

        rule, remedy = "is empty where a path is needed", 'name it, or write "." for this folder'
        raise InputError("command line", Fault("", "''", rule, remedy))
    return Path(text)


StudyArgument = Annotated[
    Path, typer.Argument(parser=a_path, metavar="STUDY", help="The study's TOML file.")
]
StudyToWarm = Annotated[
    Path | None,
    typer.Argument(
        parser=a_path, metavar="STUDY", help="Of more than two chambers: its simulation too."
    ),
]
SourcesArgument = Annotated[
    list[Path], typer.Argument(parser=a_path, metavar="A B …", help="Gains files and studies.")
]
StudiesArgument = Annotated[
    list[Path], typer.Argument(parser=a_path, metavar="STUDY …", help="The studies' TOML files.")
]
StudyOption = Annotated[
    Path | None,
    typer.Option(
        "--study",
        parser=a_path,
        metavar="STUDY",
        help="Judge all on this study's model; else each on its own.",
    ),
]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Override a key of the study; repeatable."),
]
UncertaintyOption = Annotated[
    str, typer.Option(metavar="NAME", help="Uncertainty set; the default one where not given.")
]
GainsOption = Annotated[
    Path | None,
    typer.Option(parser=a_path, metavar="FILE", help="A gains file; else the study's own."),
]
ForceOption = Annotated[
    bool, typer.Option("--force", help="Take gains whose margins are not satisfied.")
]
WorkersOption = Annotated[
    int | None, typer.Option(metavar="N", min=1, help="Processes; else one per core.")
]
SchedulerOption = Annotated[
    str, typer.Option(metavar="ADDRESS", help="A Dask scheduler, like tcp://host:8786.")
]
OutOption = Annotated[Path, typer.Option(parser=a_path, metavar="DIR", help="Folder for results.")]
JsonOption = Annotated[bool, typer.Option("--json", help="Print one JSON object, in SI.")]
QuietOption = Annotated[bool, typer.Option("--quiet", "-q", help="No progress.")]

VerboseOption = Annotated[
    bool,
    typer.Option(
        "--verbose", "-v", callback=be_verbose, help="All the details, and each stage's time."
    ),
]
TimesOption = Annotated[
    bool,
    typer.Option("--verbose", "-v", callback=be_verbose, help="Say how long each stage took."),
]

DataOption = Annotated[
    list[Path] | None,
    typer.Option(
        parser=a_path,
        metavar="FILE",
        help="Measured: a record (CSV, MAT, MDF4), or a response (CSV) without --input; "
        "repeatable.",
    ),
]

OUT = Path("reports")


def finish(*, met: bool) -> NoReturn:
    """Leave with status 0 where the verdict is *met*, else 1."""
    raise typer.Exit(0 if met else _NOT_MET)
