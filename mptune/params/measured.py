"""Measured responses of the force loop, from CSV files.

One line of headings, ``name [unit]``, upper or lower case:

==============  ==========================  ===============================================
column          names                       unit
==============  ==========================  ===============================================
frequency       frequency, freq, f, omega   rad/s or Hz, to be written
magnitude       magnitude, gain, amplitude  dB, or 1 (also - or abs); to be written
phase           phase                       deg or rad, to be written
real part       real, re                    1 (also -), or nothing
imaginary part  imaginary, imag, im         1 (also -), or nothing
coherence       coherence                   1 (also -), or nothing; the column may be missing
==============  ==========================  ===============================================

Either magnitude and phase or real and imaginary part. A phase that goes beyond half a turn is taken
as it is written, step by step; one that stays within it is unwrapped. Frequencies are positive and
rise. Any other
column is refused, so that no misspelt one is overlooked.

In a study, ``measured`` under ``[uncertainty]`` names such files. They are read at once, so that
the study, and its hash, hold what it was judged on. Each is the response from force reference,
before the hold of the sampled controller, to force: it holds G_F and the whole delay.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np
from pydantic import Field, model_validator

from mptune.errors import Fault, InputError
from mptune.headings import without_index
from mptune.params.section import Section, refuse
from mptune.params.table import BESIDE_STUDY, Table, read_table
from mptune.units import UnitError, parse_quantity

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from mptune.arrays import ComplexArray, FloatArray
    from mptune.params.layers import Layers

_FEWEST_ROWS = 4
_NAMES = {
    "frequency": ("frequency", "freq", "f", "omega", "ω"),
    "magnitude": ("magnitude", "gain", "amplitude"),
    "phase": ("phase",),
    "real": ("real", "re"),
    "imaginary": ("imaginary", "imag", "im"),
    "coherence": ("coherence",),
}
_PLAIN = {"1", "-", "abs"}
_EXAMPLE = "frequency [rad/s],magnitude [dB],phase [deg]"


class MeasuredResponse(Section):
    """A measured response that is a member of the true family."""

    name: str = Field(description="the file's name")
    rows: tuple[tuple[float, float, float], ...] = Field(
        description="frequencies [rad/s], real and imaginary parts"
    )
    phases: tuple[float, ...] = Field(
        (), description="phases as written [rad], where they go beyond half a turn"
    )

    @model_validator(mode="after")
    def _is_a_response(self) -> Self:
        if len(self.rows) < _FEWEST_ROWS:
            refuse(f"has less than {_FEWEST_ROWS} rows", "measure at more frequencies")
        omega = [row[0] for row in self.rows]
        if omega[0] <= 0 or any(after <= before for before, after in pairwise(omega)):
            refuse("has frequencies that are not above 0, or do not rise", "order the rows")
        return self

    @model_validator(mode="after")
    def _phases_fit(self) -> Self:
        if len(self.phases) not in {0, len(self.rows)}:
            raise ValueError("give as many phases as rows, or none")
        return self


class ResponseTable(NamedTuple):
    """A frequency response as a file holds it."""

    omega: FloatArray  # (F,) rad/s
    response: ComplexArray  # (F,)
    coherence: FloatArray  # (F,), NaN where not known
    phase: FloatArray | None = None  # (F,) rad, as written where that is beyond half a turn


def read_measured(layers: Layers) -> None:
    """Replace the files that ``measured`` names, in each uncertainty set, by their rows, in place.

    Paths are taken from the folder of the study that names them.

    Raises
    ------
    InputError
        If a file cannot be read or breaks a rule.
    """
    uncertainty = layers.values.get("uncertainty")
    if not isinstance(uncertainty, dict):
        return
    sets = uncertainty.get("sets")
    others = sets if isinstance(sets, dict) else {}
    boxes = {"uncertainty": uncertainty} | {
        f"uncertainty.sets.{key}": others[key] for key in others
    }
    for key, box in boxes.items():
        if not isinstance(box, dict) or not isinstance(box.get("measured"), list):
            continue
        folder = layers.folder_of(f"{key}.measured")
        box["measured"] = [
            _member(folder, file) if isinstance(file, str) else file for file in box["measured"]
        ]


def _member(folder: Path, file: str) -> dict[str, Any]:
    path = folder / file
    table = read_response_table(path, BESIDE_STUDY)
    if not np.all(np.abs(table.response) > 0):
        rule = "has a magnitude of zero, which has no phase"
        raise InputError(path, Fault("response", "", rule, "leave that row out"))
    rows = zip(table.omega, table.response.real, table.response.imag, strict=True)
    member: dict[str, Any] = {
        "name": path.stem,
        "rows": [[float(cell) for cell in row] for row in rows],
    }
    return member if table.phase is None else {**member, "phases": table.phase.tolist()}


def read_response_table(path: Path, remedy: str = "check the path") -> ResponseTable:
    """Return the frequency response of a CSV file; the module's docstring has its rules.

    The ``remedy`` says what to do where there is no such file.

    Raises
    ------
    InputError
        If the file cannot be read or breaks a rule.
    """
    table = read_table(path, _EXAMPLE, remedy)
    found = _columns(path, table)
    with np.errstate(over="ignore"):  # what becomes infinite is refused below
        values = {role: table.columns[index] * scale for role, (index, scale) in found.items()}
    omega = values["frequency"]
    if len(omega) < _FEWEST_ROWS:
        rule = f"has {len(omega)} rows where {_FEWEST_ROWS} are needed at least"
        raise InputError(path, Fault("", "", rule, "measure at more frequencies"))
    decibels = "magnitude" in found and table.units[found["magnitude"][0]].lower() == "db"
    response = _response(values, decibels=decibels)
    coherence = values.get("coherence", np.full(len(omega), np.nan))
    phase = values.get("phase")
    if phase is not None and not np.any(np.abs(phase) > np.pi * (1 + 1e-9)):
        phase = None  # wrapped into one turn
    read = ResponseTable(omega, response, coherence, phase)
    _check(path, table.lines, read)
    return read


def _response(values: Mapping[str, FloatArray], *, decibels: bool) -> ComplexArray:
    """Return the complex response, ``(F,)``; not finite where a number is too large for it."""
    with np.errstate(over="ignore", invalid="ignore"):
        if "real" in values:
            return values["real"] + 1j * values["imaginary"]
        magnitude = 10 ** (values["magnitude"] / 20) if decibels else values["magnitude"]
        return np.asarray(magnitude * np.exp(1j * values["phase"]))


def _check(path: Path, lines: tuple[int, ...], found: ResponseTable) -> None:
    omega, response, coherence, _ = found
    with np.errstate(invalid="ignore"):
        falls = np.diff(omega, prepend=0.0) <= 0
    rules = (
        (~np.isfinite(omega) | (omega <= 0), "has no frequency above 0"),
        (~np.isfinite(response), "has no response"),
        (
            falls,
            "has a frequency that does not come after the one before",
        ),
        ((coherence < 0) | (coherence > 1), "has a coherence that is not within 0 and 1"),
    )
    for broken, rule in rules:
        if broken.any():
            line = f"line {lines[int(np.argmax(broken))]}"
            raise InputError(path, Fault(line, "", rule, "mend it, or leave the line out"))


def _columns(path: Path, table: Table) -> dict[str, tuple[int, float]]:
    """Return place and factor of each column by its role."""
    found: dict[str, tuple[int, float]] = {}
    for index, written in enumerate(zip(table.labels, table.units, strict=True)):
        label, unit = without_index(*written)
        role = next((role for role, names in _NAMES.items() if label.lower() in names), "")
        if not role or role in found:
            rule = "is read already" if role else "is no column of a frequency response"
            remedy = f"remove it, or write headings like {_EXAMPLE}"
            raise InputError(path, Fault("header", label, rule, remedy))
        found[role] = index, _scale(path, role, label, unit)
    pairs = ({"magnitude", "phase"}, {"real", "imaginary"})
    held = [pair & set(found) for pair in pairs]
    if "frequency" not in found or sorted(map(len, held)) != [0, 2]:
        rule = f"is {','.join(table.labels)}"
        remedy = f"write a frequency and either pair, like {_EXAMPLE}"
        raise InputError(path, Fault("header", "", rule, remedy))
    return found


def _scale(path: Path, role: str, label: str, unit: str) -> float:
    if role in {"real", "imaginary", "coherence"} and (not unit or unit in _PLAIN):
        return 1.0
    if role == "magnitude" and (unit in _PLAIN or unit.lower() == "db"):
        return 1.0
    if role in {"frequency", "phase"}:
        try:
            return _factor(role, unit)
        except UnitError as error:
            raise InputError(path, Fault("header", label, error.rule, error.remedy)) from error
    rule = f"has the unit {unit!r}" if unit else "has no unit"
    raise InputError(path, Fault("header", label, rule, "write dB or 1; a force over a force"))


def _factor(role: str, unit: str) -> float:
    if role == "phase":
        return parse_quantity(f"1 {unit}", "rad")
    if unit.endswith("Hz"):
        return 2 * np.pi * parse_quantity(f"1 {unit}", "Hz")
    return parse_quantity(f"1 {unit}", "rad/s")
