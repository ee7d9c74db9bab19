"""Measured data of the force loop: read, turned into responses, fitted, written.

::

    <out>/<study>/measured/<record>.csv       the response, as a study's ``measured`` can name it
    <out>/<study>/measured/uncertainty.toml   the fitted ranges, as a study's ``[uncertainty]``
    <out>/<study>/measured/fit.svg            responses and fits
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.errors import Fault, InputError
from mptune.files import make_folder, write_whole
from mptune.identify.fit import fit
from mptune.identify.ranges import fitted_ranges, uncertainty_section
from mptune.identify.responses import read_response, write_response
from mptune.identify.spectrum import periodic_response, welch_response
from mptune.identify.timeseries import read_record
from mptune.progress import silent

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.identify.fitted import Fit
    from mptune.identify.response import FrequencyResponse
    from mptune.identify.timeseries import Asked, Record
    from mptune.params.section import Range
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress


@dataclass(frozen=True)
class Reading:
    """Which data to read, and how.

    Attributes
    ----------
    files
        Records; frequency responses where no channels are ``asked`` for.
    asked
        The channels of the records.
    period
        Period of a periodic reference [s]; Welch's method where None.
    skip
        Start of each record to leave out [s]; one period, or nothing, where None.
    segment
        Length of a segment of Welch's method [s].
    band
        Lowest and highest frequency [rad/s].
    held
        Whether the reference was recorded behind the hold of the sampled controller, as stairs:
        the response then lacks T_S/2, which the study's delay holds.
    """

    files: tuple[Path, ...]
    asked: Asked | None = None
    period: float | None = None
    skip: float | None = None
    segment: float | None = None
    band: Range = (0.0, np.inf)
    held: bool = False


@dataclass(frozen=True)
class MeasuredResult:
    """Responses and what was fitted to them; ``ranges`` and ``section`` are the study's to take."""

    responses: tuple[FrequencyResponse, ...]
    fits: tuple[Fit, ...]
    ranges: dict[str, Range]
    section: str

    @property
    def satisfied(self) -> bool:
        """Whether every response is fitted well; its intervals hold both orders of τ_A and τ_B."""
        return all(one.good for one in self.fits)

    def json(self) -> dict[str, Any]:
        """Return the result in SI, units in the keys."""
        return {
            "fits": [one.json() for one in self.fits],
            "uncertainty": {f"{name}_s": list(pair) for name, pair in self.ranges.items()},
            "satisfied": self.satisfied,
        }


def identify_data(
    study: ResolvedStudy,
    reading: Reading,
    out: str | Path,
    progress: Progress = silent,
) -> tuple[MeasuredResult, tuple[Path, ...]]:
    """Read measured data, fit Eq. 11 and a dead time, and write responses and ranges.

    Raises
    ------
    InputError
        If the data cannot be used.
    OutputError
        If results cannot be written.
    """
    from mptune.figures.measured import fitted_responses
    from mptune.figures.style import to_svg

    names = [path.stem for path in reading.files]
    if len(set(names)) < len(names):
        fault = Fault("", "", "holds two files of one name", "name the files differently")
        raise InputError("--data", fault)
    folder = make_folder(Path(out) / study.name / "measured")
    share_a = study.study.share_a
    responses, fits = [], []
    for number, path in enumerate(reading.files):
        progress("identify", number / len(reading.files))
        responses.append(_response(path, reading))
        fits.append(fit(responses[-1], share_a, reading.band))
    held = 0.5 * study.study.controller.sampling_period if reading.held else 0.0
    files = [write_response(folder / f"{one.name}.csv", one) for one in responses]
    # A response without T_S/2 is no member of the true family: its file is not proposed as one.
    members = [] if reading.held else [path.name for path in files]
    section = uncertainty_section(fits, study.uncertainty, members, held)
    ranges = fitted_ranges(fits, held)
    files.append(write_whole(folder / "uncertainty.toml", section))
    progress("figures", 0.0)
    figure = to_svg(fitted_responses(responses, fits, share_a))
    files.append(write_whole(folder / "fit.svg", figure))
    return MeasuredResult(tuple(responses), tuple(fits), ranges, section), tuple(files)


def _response(path: Path, reading: Reading) -> FrequencyResponse:
    if reading.asked is None:
        return read_response(path)
    record = read_record(path, reading.asked)
    skip = reading.skip if reading.skip is not None else reading.period or 0.0
    first = round(skip / record.sample_time)
    if first >= len(record.force):
        length = len(record.force) * record.sample_time
        rule = f"leaves nothing of a record of {length:g} s"
        raise InputError(path, Fault("skip", f"{skip:g} s", rule, "leave less out"))
    if reading.period is not None:
        return _periods(path, record, first, reading.period, reading.band)
    return welch_response(
        record.reference[first:],
        record.force[first:],
        record.sample_time,
        record.name,
        segment=reading.segment,
        band=reading.band,
    )


def _periods(
    path: Path, record: Record, first: int, period: float, band: Range
) -> FrequencyResponse:
    """Return the response at every excited line of the whole periods behind sample ``first``."""
    samples = round(period / record.sample_time)
    if samples < 1 or abs(samples * record.sample_time - period) > 1e-6 * period:
        rule = f"is no whole number of samples of {1e3 * record.sample_time:g} ms"
        raise InputError(path, Fault("period", f"{period:g} s", rule, "give the exact period"))
    periods = (len(record.force) - first) // samples
    if periods < 1:
        rule = "fits in no whole number behind the start that is left out"
        raise InputError(path, Fault("period", f"{period:g} s", rule, "record longer"))
    numbers = np.arange(1, (samples - 1) // 2 + 1, dtype=np.float64)
    lines: FloatArray = 2 * np.pi / (samples * record.sample_time) * numbers
    lines = lines[(lines >= band[0]) & (lines <= band[1])]
    used = slice(first, first + periods * samples)
    return periodic_response(
        record.reference[used], record.force[used], record.sample_time, lines, periods, record.name
    )
