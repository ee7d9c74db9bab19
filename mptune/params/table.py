"""CSV files of numbers: one line of headings with units, then rows.

Cells stand between commas, semicolons or tabs, whichever the first line has most of; the decimal
sign is a point. An empty cell is NaN.
"""

from __future__ import annotations

import csv
import io
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.errors import Fault, InputError
from mptune.files import read_text
from mptune.units import label_and_unit

if TYPE_CHECKING:
    from pathlib import Path

    from mptune.arrays import FloatArray


class Table(NamedTuple):
    """Columns by their headings."""

    labels: tuple[str, ...]
    units: tuple[str, ...]  # as written; empty where there is none
    columns: FloatArray  # (columns, rows)


def read_table(path: Path) -> Table:
    """Return the table of a CSV file.

    Raises
    ------
    InputError
        If the file cannot be read, a line has too few or too many cells (a truncated file, say), a
        cell is no number, or two columns have one name.
    """
    text = read_text(path).removeprefix("\ufeff").lstrip("\r\n")
    first = text.partition("\n")[0]
    delimiter = max(",;\t", key=first.count)
    lines = csv.reader(io.StringIO(text), delimiter=delimiter)
    headings = [label_and_unit(cell) for cell in next(lines)]
    labels = tuple(label for label, _ in headings)
    for label in labels:
        if labels.count(label) > 1:
            raise InputError(path, Fault("header", label, "names two columns", "rename one"))
    rows = [_numbers(path, row, lines.line_num, len(labels)) for row in lines if row]
    columns = np.array(rows, np.float64).reshape(len(rows), len(labels)).T
    return Table(labels, tuple(unit for _, unit in headings), np.ascontiguousarray(columns))


def _numbers(path: Path, row: list[str], line: int, count: int) -> list[float]:
    if len(row) != count:
        rule = f"has {len(row)} cells where the header has {count}"
        remedy = "mend it; where it is the last line, the file was cut off: record or copy it again"
        raise InputError(path, Fault(f"line {line}", "", rule, remedy))
    try:
        return [float(cell) if cell.strip() else math.nan for cell in row]
    except ValueError as error:
        rule = "is no row of numbers"
        remedy = "write plain numbers with a decimal point, below one line of headings"
        raise InputError(path, Fault(f"line {line}", ",".join(row)[:40], rule, remedy)) from error
