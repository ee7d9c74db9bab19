"""Recorded references and a boom's table, from CSV files.

They are read at once, so that the study, and its hash, hold what it was judged on.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.errors import Fault, InputError
from mptune.headings import without_index
from mptune.params.machine import FEWEST_ROWS
from mptune.params.manoeuvre import FEWEST_SAMPLES
from mptune.params.table import BESIDE_STUDY, read_table
from mptune.units import UnitError, parse_quantity

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from mptune.params.layers import Layers
    from mptune.params.table import Table

_REFERENCE = {"time": "s", "position": "m"}
_LOAD_TABLE = {"position": "m", "force": "N", "inertia": "1"}
_PLAIN = {"", "1", "-"}


def read_references(layers: Layers) -> None:
    """Replace ``file`` in each manoeuvre by its samples and their duration, in place.

    A file has two columns with a header that names their units, ``time [s],position [mm]``, and
    rising times. Its path is taken from the folder of the study that names it.

    Raises
    ------
    InputError
        If a file cannot be read or breaks a rule.
    """
    manoeuvres = layers.values.get("manoeuvre")
    folder = layers.folder_of("manoeuvre")
    for move in manoeuvres if isinstance(manoeuvres, list) else []:
        if isinstance(move, dict) and isinstance(move.get("file"), str):
            samples = _read(folder / move.pop("file"), _REFERENCE, FEWEST_SAMPLES)
            move["samples"] = samples
            move["duration"] = f"{samples[-1][0] - samples[0][0]!r} s"


def read_load_table(layers: Layers) -> None:
    """Replace the ``table`` that ``[load]`` names by its rows, in place.

    The file has the columns ``position [mm],force [kN],inertia [-]``: load force added and factor
    of the inertia at rising piston positions. Its path is taken from the folder of the study that
    names it.

    Raises
    ------
    InputError
        If the file cannot be read or breaks a rule.
    """
    load: Any = layers.values.get("load")
    if isinstance(load, dict) and isinstance(load.get("table"), str):
        path = layers.folder_of("load.table") / load["table"]
        rows = _read(path, _LOAD_TABLE, FEWEST_ROWS)
        if any(row[2] <= 0 for row in rows):
            raise InputError(path, Fault("inertia", "", "is not positive", "give factors above 0"))
        load["table"] = rows


def _read(path: Path, columns: Mapping[str, str], fewest: int) -> list[list[float]]:
    """Return the rows of a file in SI, the first of its columns rising."""
    heading = ",".join(f"{name} [{unit}]" for name, unit in columns.items())
    table = read_table(path, heading, BESIDE_STUDY)
    with np.errstate(over="ignore"):  # what becomes infinite is refused next
        values = table.columns * np.array(_scales(path, table, columns, heading))[:, None]
    finite = np.isfinite(values).all(axis=0)
    if not finite.all():
        line = f"line {table.lines[int(np.argmin(finite))]}"
        raise InputError(path, Fault(line, "", "is no row of numbers", "mend it"))
    rises = np.diff(values[0], prepend=-np.inf) > 0
    if not rises.all():
        line = f"line {table.lines[int(np.argmin(rises))]}"
        rule, remedy = "does not come after the line before", "let the first column rise"
        raise InputError(path, Fault(line, "", rule, remedy))
    if len(table.lines) < fewest:
        rule = f"has {len(table.lines)} rows where {fewest} are needed at least"
        raise InputError(path, Fault("", "", rule, "record more"))
    rows: list[list[float]] = values.T.tolist()
    return rows


def _scales(path: Path, table: Table, columns: Mapping[str, str], heading: str) -> list[float]:
    """Return the SI values of the columns' units; "-" or nothing stands for a plain number."""
    written = [without_index(*pair) for pair in zip(table.labels, table.units, strict=True)]
    labels = [label.lower() for label, _ in written]
    if labels != list(columns):
        fault = Fault("header", "", f"is {','.join(table.labels)!r}", f"write {heading}")
        raise InputError(path, fault)
    scales = []
    for (label, given), unit in zip(written, columns.values(), strict=True):
        try:
            plain = unit == "1" and given in _PLAIN
            scales.append(1.0 if plain else parse_quantity(f"1 {given}", unit))
        except UnitError as error:
            remedy = f"{error.remedy}; a heading that would do is {heading}"
            raise InputError(path, Fault("header", label, error.rule, remedy)) from error
    return scales
