"""``mptune systems``: other actuators under the same load and moves."""

from __future__ import annotations

from mptune.cli.options import (
    OUT,
    GainsOption,
    JsonOption,
    OutOption,
    QuietOption,
    SetOption,
    StudyArgument,
    TimesOption,
    UncertaintyOption,
    finish,
)


def systems(
    study: StudyArgument,
    gains: GainsOption = None,
    override: SetOption = None,
    uncertainty: UncertaintyOption = "",
    out: OutOption = OUT,
    json: JsonOption = False,
    quiet: QuietOption = False,
    _verbose: TimesOption = False,
) -> None:
    """Compare the machine with other actuators under the same load and moves."""
    from mptune.cli import show, show_systems
    from mptune.cli.study import load_study, with_warnings
    from mptune.job.systems import systems_study

    loaded = load_study(study, override or (), uncertainty)
    with show.progress(quiet=quiet) as report:
        compared = systems_study(loaded, out, report, gains)
    if json:
        show.as_json(with_warnings(compared.json(), loaded))
    else:
        show.elsewhere(compared.differs)
        show_systems.systems(compared.result)
        show.files(compared.files)
    finish(met=compared.result.satisfied)
