"""``mptune identify``: the force loop's frequency response against Eq. 11."""

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
    finish,
)


def identify(
    study: StudyArgument,
    excitation: Annotated[
        str, typer.Option(metavar="SHAPE", help="sine (as in the paper), multisine or chirp.")
    ] = "sine",
    delay: Annotated[
        list[str] | None,
        typer.Option(metavar="TIME", help='Valve delay, like "8 ms", instead of the study\'s.'),
    ] = None,
    override: SetOption = None,
    out: OutOption = OUT,
    json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Compare the force loop's frequency response with Eq. 11 (Fig. 3)."""
    from mptune.cli import show, show_identify
    from mptune.identify.excitation import excitation_named
    from mptune.job.identify import identify_study
    from mptune.params.load import load_study

    shape = excitation_named(excitation)
    overrides = list(override or ())
    if delay:
        overrides.append(f"identification.valve_delays={delay!r}")
    loaded = load_study(study, overrides)
    with show.progress(quiet=quiet) as report:
        result, files = identify_study(loaded, shape, out, report)
    if json:
        show.as_json(result.json())
    else:
        show_identify.identified(result)
        show.files(files)
    finish(met=result.satisfied)
