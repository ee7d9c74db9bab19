"""``mptune compare``: gains files and studies side by side."""

from __future__ import annotations

from mptune.cli.options import (
    OUT,
    JsonOption,
    OutOption,
    QuietOption,
    SetOption,
    SourcesArgument,
    StudyOption,
    TimesOption,
    UncertaintyOption,
    finish,
)


def compare(
    sources: SourcesArgument,
    study: StudyOption = None,
    override: SetOption = None,
    uncertainty: UncertaintyOption = "",
    out: OutOption = OUT,
    json: JsonOption = False,
    quiet: QuietOption = False,
    _verbose: TimesOption = False,
) -> None:
    """Compare two or more gains files or studies in one table and one figure."""
    from mptune.cli import show
    from mptune.cli.show_compare import compared, told
    from mptune.job.compare import compare as compare_job

    with show.progress(quiet=quiet) as report:
        found, files = compare_job(
            sources, study, out, report, overrides=override or (), uncertainty=uncertainty
        )
    if json:
        values = {"compared": [one.json() for one in found], "files": [str(path) for path in files]}
        show.as_json(values)
    else:
        told(found)
        compared(found)
        show.files(files)
    finish(met=all(one.judgement.met for one in found))
