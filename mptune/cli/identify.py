"""``mptune identify``: the force loop's frequency response against Eq. 11, or measured data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from mptune.cli.options import (
    OUT,
    DataOption,
    JsonOption,
    OutOption,
    QuietOption,
    SetOption,
    StudyArgument,
    TimesOption,
    UncertaintyOption,
    finish,
)

if TYPE_CHECKING:
    from pathlib import Path

    from mptune.job.measured import Reading


def identify(
    study: StudyArgument,
    excitation: Annotated[
        str, typer.Option(metavar="SHAPE", help="sine (as in the paper), multisine or chirp.")
    ] = "sine",
    delay: Annotated[
        list[str] | None,
        typer.Option(metavar="TIME", help='Valve delay, like "8 ms", instead of the study\'s.'),
    ] = None,
    data: DataOption = None,
    input_channel: Annotated[
        str, typer.Option("--input", metavar="CHANNEL", help='Reference, like "F_ref [kN]".')
    ] = "",
    output_channel: Annotated[
        str, typer.Option("--output", metavar="CHANNEL", help='Force, like "F [kN]".')
    ] = "",
    time_channel: Annotated[
        str, typer.Option("--time", metavar="CHANNEL", help='Time, like "t [ms]".')
    ] = "",
    sample_time: Annotated[
        str, typer.Option(metavar="TIME", help="Time between samples, where none is recorded.")
    ] = "",
    period: Annotated[
        str, typer.Option(metavar="TIME", help="Period of a periodic reference, like a multisine.")
    ] = "",
    skip: Annotated[
        str, typer.Option(metavar="TIME", help="Start to leave out; one period by default.")
    ] = "",
    segment: Annotated[
        str, typer.Option(metavar="TIME", help="Segment of Welch's method, without --period.")
    ] = "",
    band: Annotated[
        tuple[str, str],
        typer.Option(metavar="LOW HIGH", help='Frequencies to use, like "2 rad/s" "200 rad/s".'),
    ] = ("", ""),
    held: Annotated[
        bool, typer.Option("--held", help="Reference recorded as stairs, behind the hold.")
    ] = False,
    override: SetOption = None,
    uncertainty: UncertaintyOption = "",
    out: OutOption = OUT,
    json: JsonOption = False,
    quiet: QuietOption = False,
    _verbose: TimesOption = False,
) -> None:
    """Compare the simulated force loop with its theory (Fig. 3), or fit measured data."""
    channels = (input_channel, output_channel, time_channel, sample_time)
    settings = {"--period": period, "--skip": skip, "--segment": segment}
    if data or any(channels) or any(settings.values()) or any(band) or held:
        reading = _reading(data, channels, settings, band, held)
        _measured(study, reading, list(override or ()), uncertainty, out, json, quiet)
    from mptune.cli import show, show_identify
    from mptune.cli.study import load_study, with_warnings
    from mptune.identify.excitation import excitation_named
    from mptune.job.identify import identify_study

    shape = excitation_named(excitation)
    overrides = list(override or ())
    if delay:
        overrides.append(f"identification.valve_delays={delay!r}")
    loaded = load_study(study, overrides, uncertainty)
    with show.progress(quiet=quiet) as report:
        result, files = identify_study(loaded, shape, out, report)
    if json:
        show.as_json(with_warnings(result.json(), loaded))
    else:
        show_identify.identified(result)
        show.files(files)
    finish(met=result.satisfied)


def _reading(
    data: list[Path] | None,
    channels: tuple[str, str, str, str],
    settings: dict[str, str],
    band: tuple[str, str],
    held: bool,
) -> Reading:
    """Return what to read of measured data, as the options say."""
    from mptune.errors import Fault, InputError
    from mptune.identify.timeseries import Asked
    from mptune.job.measured import Reading

    if not data:
        raise InputError("--data", Fault("", "", "is missing", "name the measured file"))
    if bool(channels[0]) != bool(channels[1]):
        fault = Fault("", "", "belong together", "give both channels of a record, or neither")
        raise InputError("--input and --output", fault)
    if not channels[0] and (any(channels) or any(settings.values()) or held):
        fault = Fault("", "", "are missing", "name the channels of the record")
        raise InputError("--input and --output", fault)
    period, skip, segment = (_quantity(key, text, "s") for key, text in settings.items())
    low, high = (_quantity("--band", text, "rad/s") for text in band)
    return Reading(
        files=tuple(data),
        asked=Asked(*channels) if channels[0] else None,
        period=period,
        skip=skip,
        segment=segment,
        band=(low or 0.0, float("inf") if high is None else high),
        held=held,
    )


def _quantity(option: str, text: str, unit: str) -> float | None:
    """Return an option's quantity in SI, None where it is not given; refuse what is not above 0."""
    from mptune.errors import Fault, InputError
    from mptune.units import UnitError, parse_quantity

    if not text:
        return None
    try:
        value = parse_quantity(text, unit)
    except UnitError as error:
        raise InputError(option, Fault("", text, error.rule, error.remedy)) from error
    if value < 0 or (value == 0 and option != "--skip"):
        raise InputError(option, Fault("", text, "is not above 0", "give a larger value"))
    return value


def _measured(
    study: Path,
    reading: Reading,
    overrides: list[str],
    uncertainty: str,
    out: Path,
    json: bool,
    quiet: bool,
) -> None:
    """Fit measured data and leave."""
    from mptune.cli import show, show_identify
    from mptune.cli.study import load_study, with_warnings
    from mptune.job.measured import identify_data

    loaded = load_study(study, overrides, uncertainty)
    with show.progress(quiet=quiet) as report:
        result, files = identify_data(loaded, reading, out, report)
    if json:
        show.as_json(with_warnings(result.json(), loaded))
    else:
        show_identify.measured(result)
        show.files(files)
    finish(met=result.satisfied)
