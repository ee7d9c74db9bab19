"""Recorded references and a boom's table, from CSV files.

They are read at once, so that the study, and its hash, hold what it was judged on.
"""

from __future__ import annotations

import csv
import io
import math
from typing import TYPE_CHECKING, Any

from mptune.errors import Fault, InputError
from mptune.files import read_text
from mptune.units import UnitError, label_and_unit, parse_quantity

if TYPE_CHECKING:
    from pathlib import Path

_FEWEST_SAMPLES, _FEWEST_ROWS = 4, 2


def read_references(study: Path, values: dict[str, Any]) -> None:
    """Replace ``file`` in each manoeuvre by its samples and their duration, in place.

    A file has two columns with a header that names their units, ``time [s],position [mm]``, and
    rising times. Its path is taken from the study's folder.

    Raises
    ------
    InputError
        If a file cannot be read or breaks a rule.
    """
    manoeuvres = values.get("manoeuvre")
    for move in manoeuvres if isinstance(manoeuvres, list) else []:
        if isinstance(move, dict) and isinstance(move.get("file"), str):
            samples = _read(
                study.parent / move.pop("file"), (("time", "s"), ("position", "m")), _FEWEST_SAMPLES
            )
            move["samples"] = samples
            move["duration"] = f"{samples[-1][0] - samples[0][0]!r} s"


def read_load_table(study: Path, values: dict[str, Any]) -> None:
    """Replace the ``table`` that ``[load]`` names by its rows, in place.

    The file has the columns ``position [mm],force [kN],inertia [-]``: load force added and factor
    of the inertia at rising piston positions.

    Raises
    ------
    InputError
        If the file cannot be read or breaks a rule.
    """
    load = values.get("load")
    if isinstance(load, dict) and isinstance(load.get("table"), str):
        path = study.parent / load["table"]
        columns = (("position", "m"), ("force", "N"), ("inertia", "1"))
        rows = _read(path, columns, _FEWEST_ROWS)
        if any(row[2] <= 0 for row in rows):
            raise InputError(path, Fault("inertia", "", "is not positive", "give factors above 0"))
        load["table"] = rows


def _read(path: Path, columns: tuple[tuple[str, str], ...], fewest: int) -> list[list[float]]:
    rows = list(csv.reader(io.StringIO(read_text(path))))
    scales = _scales(path, rows[0], columns)
    samples: list[list[float]] = []
    for line, row in enumerate(rows[1:], start=2):
        try:
            numbers = [float(cell) * scale for cell, scale in zip(row, scales, strict=True)]
        except ValueError:
            numbers = [math.nan]
        if not all(math.isfinite(number) for number in numbers):
            raise InputError(path, Fault(f"line {line}", "", "is no row of numbers", "mend it"))
        if samples and numbers[0] <= samples[-1][0]:
            fault = Fault(
                f"line {line}",
                "",
                "does not come after the line before",
                "let the first column rise",
            )
            raise InputError(path, fault)
        samples.append(numbers)
    if len(samples) < fewest:
        rule = f"has {len(samples)} rows where {fewest} are needed at least"
        raise InputError(path, Fault("", "", rule, "record more"))
    return samples


def _scales(path: Path, header: list[str], wanted: tuple[tuple[str, str], ...]) -> list[float]:
    """Return the SI values of the columns' units; "-" stands for a plain number."""
    labels = [label_and_unit(cell) for cell in header]
    if [label for label, _ in labels] != [name for name, _ in wanted]:
        rule = f"is {','.join(header)!r}"
        remedy = "write " + ",".join(f"{name} [{unit}]" for name, unit in wanted)
        raise InputError(path, Fault("header", "", rule, remedy))
    scales = []
    for (_, written), (_, unit) in zip(labels, wanted, strict=True):
        try:
            scales.append(1.0 if unit == "1" else parse_quantity(f"1 {written}", unit))
        except UnitError as error:
            raise InputError(path, Fault("header", "", error.rule, error.remedy)) from error
    return scales
