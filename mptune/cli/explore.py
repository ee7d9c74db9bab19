"""``mptune explore``: gains turned by hand in a browser."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from mptune.cli.options import OUT, OutOption, SetOption, StudyArgument, UncertaintyOption


def explore(
    study: StudyArgument,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open the page in a browser.")
    ] = True,
    end_with_last_tab: Annotated[
        float | None,
        typer.Option(metavar="SECONDS", min=0, help="End this long after the last tab has closed."),
    ] = None,
    override: SetOption = None,
    uncertainty: UncertaintyOption = "",
    out: OutOption = OUT,
) -> None:
    """Turn gains by hand in a browser, everything moving; Ctrl-C ends it."""
    from mptune.cli.study import load_study
    from mptune.explore.explore import explore as serve

    load_study(study, override or (), uncertainty)  # says what is doubtful

    def listening(address: str) -> None:
        sys.stdout.write(f"{address}\n")
        sys.stdout.flush()
        if browser:
            import webbrowser

            webbrowser.open(address)

    serve(
        study, tuple(override or ()), uncertainty, out, grace=end_with_last_tab, listening=listening
    )
