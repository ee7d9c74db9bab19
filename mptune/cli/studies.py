"""``mptune studies``: several studies, each as ``mptune run`` does it, in one table and figure."""

from __future__ import annotations

from mptune.cli.options import (
    OUT,
    JsonOption,
    OutOption,
    QuietOption,
    SetOption,
    StudiesArgument,
    TimesOption,
    finish,
)


def studies(
    sources: StudiesArgument,
    override: SetOption = None,
    out: OutOption = OUT,
    json: JsonOption = False,
    quiet: QuietOption = False,
    _verbose: TimesOption = False,
) -> None:
    """Run several studies, and show them side by side beside the paper's measurements."""
    from mptune.cli import show
    from mptune.cli.study import load_study
    from mptune.cli.terminal import show as table
    from mptune.job.studies import run_studies
    from mptune.report.content.studies import compared_studies

    loaded = [load_study(path, override or ()) for path in sources]
    with show.progress(quiet=quiet) as report:
        found = run_studies(loaded, out, report)
    if json:
        show.as_json(found.json())
    else:
        for one in found.runs:
            show.say(f"{one.study.name}: {one.judgement.line}")
        table(compared_studies(found.rows))
        show.files(found.files)
    finish(met=found.satisfied)
