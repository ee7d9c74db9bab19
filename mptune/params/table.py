"""CSV files of numbers: one line of headings with units, then rows.

One tolerance for every file of the kind, whoever reads it:

* UTF-8, with or without a byte-order mark; line ends of any system.
* Cells between commas, semicolons or tabs, whichever the headings have most of, and spaces
  around them.
* The decimal sign is a point. Between semicolons it may be a comma as well, which can mean
  nothing else there; a file that has both signs is refused, for one of them might group digits.
* Blank lines count for nothing, and neither do rows of empty cells at the end. Elsewhere an empty
  cell is NaN: whether a value may be missing is the reader's rule.
"""

from __future__ import annotations

import csv
import io
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.errors import Fault, InputError
from mptune.files import read_text
from mptune.headings import label_and_unit

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from mptune.arrays import FloatArray

BESIDE_STUDY = "check the path: it is taken from the folder of the study that names it"
"""What to do about a table that a study names and that is not there."""


class Table(NamedTuple):
    """Columns by their headings."""

    labels: tuple[str, ...]
    units: tuple[str, ...]  # as written; empty where there is none
    columns: FloatArray  # (columns, rows)
    lines: tuple[int, ...]  # (rows,) where in the file each row stands


class _Row(NamedTuple):
    line: int
    cells: list[str]

    @property
    def blank(self) -> bool:
        return not any(cell.strip() for cell in self.cells)


def read_table(path: Path, heading: str, remedy: str = "check the path") -> Table:
    """Return the table of a CSV file.

    Parameters
    ----------
    path
        The file.
    heading
        A line of headings that would do, for print.
    remedy
        What to do where there is no such file, or nothing in it.

    Raises
    ------
    InputError
        If the file cannot be read, has no line of headings, a line has too few or too many cells
        (a truncated file, say), a cell is no number, or two columns have one name.
    """
    text = read_text(path, remedy)
    separator = _separator(text)
    rows = _rows(path, text, separator)
    if not rows:
        raise InputError(path, Fault("", "", "is empty", remedy))
    labels, units = _headings(path, rows.pop(0), heading)
    comma = separator == ";" and _has_decimal_commas(path, rows)
    numbers = [_numbers(path, row, labels, heading, comma=comma) for row in rows]
    columns = np.array(numbers, np.float64).reshape(len(rows), len(labels)).T
    return Table(labels, units, np.ascontiguousarray(columns), tuple(row.line for row in rows))


def _separator(text: str) -> str:
    """Return what stands between the cells of the first line that holds anything."""
    first = next((line for line in text.splitlines() if line.strip()), "")
    return max("\t;,", key=first.count)


def _rows(path: Path, text: str, separator: str) -> list[_Row]:
    """Return the lines that hold anything, split into cells."""
    reader = csv.reader(io.StringIO(text, newline=None), delimiter=separator)
    try:
        rows = [_Row(reader.line_num, cells) for cells in reader]
    except csv.Error as error:
        fault = Fault(f"line {reader.line_num}", "", f"is no row of cells: {error}", "mend it")
        raise InputError(path, fault) from error
    rows = [row for row in rows if len(row.cells) > 1 or not row.blank]
    while rows and rows[-1].blank:
        rows.pop()
    return rows


def _headings(path: Path, row: _Row, heading: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the names of the columns, and their units as written."""
    if all(_is_number(cell) for cell in row.cells):
        rule, remedy = "holds numbers and no headings", f"put one line before it, like {heading}"
        raise InputError(path, Fault(f"line {row.line}", "", rule, remedy))
    labels, units = zip(*map(label_and_unit, row.cells), strict=True)
    for label in labels:
        if labels.count(label) > 1:
            rule, remedy = "names two columns", f"rename one; headings read like {heading}"
            raise InputError(path, Fault("header", label, rule, remedy))
    return labels, units


def _is_number(cell: str) -> bool:
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return True


def _has_decimal_commas(path: Path, rows: Sequence[_Row]) -> bool:
    """Return whether the numbers of a file with semicolons have commas; never points as well."""
    with_comma = next((row for row in rows if any("," in cell for cell in row.cells)), None)
    if with_comma is None:
        return False
    if any("." in cell for row in rows for cell in row.cells):
        rule = "has a comma within a number of a file that has decimal points as well"
        remedy = "write one decimal sign throughout, and group no digits"
        raise InputError(path, Fault(f"line {with_comma.line}", "", rule, remedy))
    return True


def _numbers(
    path: Path, row: _Row, labels: Sequence[str], heading: str, *, comma: bool
) -> list[float]:
    found, wanted = len(row.cells), len(labels)
    if found != wanted:
        rule = f"has {found} cells where the header has {wanted}"
        remedy = "mend it; where it is the last line, the file was cut off: record or copy it again"
        if found > wanted:
            remedy = "mend it; where the decimal sign is a comma, separate cells by semicolons"
        raise InputError(path, Fault(f"line {row.line}", "", rule, remedy))
    cells = [cell.replace(",", ".") for cell in row.cells] if comma else row.cells
    try:
        numbers = [float(cell) if cell.strip() else math.nan for cell in cells]
    except ValueError as error:
        shown = ",".join(row.cells)[:40]
        remedy = f"write plain numbers with a decimal point below one line like {heading}"
        fault = Fault(f"line {row.line}", shown, "is no row of numbers", remedy)
        raise InputError(path, fault) from error
    if any(map(math.isinf, numbers)):
        shown = ",".join(row.cells)[:40]
        rule = "has a number beyond all bounds"
        raise InputError(path, Fault(f"line {row.line}", shown, rule, "mend it, or leave it empty"))
    return numbers
