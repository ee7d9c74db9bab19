"""Prints the report's tables on a terminal, and JSON for programs.

A table that is too wide for the terminal is printed as a list: one paragraph for each row, every
value behind its heading, so that no number is ever broken over two lines.
"""

from __future__ import annotations

import json
import re
import sys
from typing import TYPE_CHECKING, Any, Literal

from rich import box
from rich.cells import cell_len
from rich.console import Console
from rich.table import Table
from rich.text import Text

from mptune.report.blocks import Cell, Tabular, verdict
from mptune.strict import strict

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from mptune.report.blocks import Block, Column

_PIPE_WIDTH = 120  # columns, where the output is no terminal
_GAP = 2  # between columns
_WORD = re.compile(r"\[.*?\]|\S+")  # a unit counts as one
_STYLES = {"good": "green", "bad": "bold red", "strong": "bold"}

console = Console(
    width=None if sys.stdout.isatty() else _PIPE_WIDTH, markup=False, emoji=False, highlight=False
)


def as_json(values: dict[str, Any]) -> None:
    """Print one JSON object; what JSON cannot say (NaN, infinity) becomes null."""
    console.file.write(json.dumps(strict(values), allow_nan=False) + "\n")


def say(*parts: str | Cell) -> None:
    """Print a line, words with a look in it."""
    console.print(*(_text(part) for part in parts))


def opening(texts: Sequence[str], warnings: Sequence[str] = (), *, good: bool = True) -> None:
    """Print what stands before the tables: texts, the first of them a verdict, and warnings."""
    for text in texts[:1]:
        say(verdict(text, good=good))
    for text in texts[1:]:
        say(text)
    for text in warnings:
        say(verdict(text, good=False))
    if texts or warnings:
        say("")


def files(paths: Iterable[Path]) -> None:
    """Print what was written."""
    for path in paths:
        console.print(Text(f"wrote {path}"), soft_wrap=True)


def show(*blocks: Block, brief: bool = False, ruled: bool = False) -> None:
    """Print the tables among blocks, each under its title; the rest is for paper.

    Parameters
    ----------
    blocks
        Of the report, or made alike.
    brief
        Whether to leave out the columns of detail.
    ruled
        Whether to part rows by lines, where their texts are long.
    """
    for block in blocks:
        if isinstance(block, Tabular):
            _table(block, brief=brief, ruled=ruled)


def _table(block: Tabular, *, brief: bool, ruled: bool) -> None:
    shown = [n for n, column in enumerate(block.columns) if not (brief and column.detail)]
    columns = [block.columns[n] for n in shown]
    rows = [[_text(row[n]) for n in shown] for row in block.rows]
    console.print(Text(block.title, "bold"))
    widths = _widths(columns, rows, console.width - _GAP * (len(columns) - 1))
    fits = sum(widths) + _GAP * (len(columns) - 1) <= console.width
    console.print(_grid(columns, rows, widths, ruled=ruled) if fits else _list(columns, rows))
    console.print()


def _grid(
    columns: list[Column], rows: list[list[Text]], widths: list[int], *, ruled: bool
) -> Table:
    made = Table(
        box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1, 0, 0), show_lines=ruled
    )
    for column, width in zip(columns, widths, strict=True):
        justify: Literal["left", "right"] = "right" if column.align == "right" else "left"
        made.add_column(Text(column.text), justify=justify, vertical="top", width=width)
    for row in rows:
        made.add_row(*row)
    return made


def _widths(columns: list[Column], rows: list[list[Text]], room: int) -> list[int]:
    """Return the columns' widths: the widest give way, but no word and no number is broken."""
    widths, least = [], []
    for n, column in enumerate(columns):
        texts, words = [row[n].plain for row in rows], _WORD.findall(column.text)
        words += texts if column.align == "right" else _WORD.findall(" ".join(texts))
        least.append(max(map(cell_len, words), default=0))
        lines = "\n".join((column.text, *texts)).splitlines()
        widths.append(max(map(cell_len, lines), default=0))
    while sum(widths) > room and widths != least:
        loose = [n for n, width in enumerate(widths) if width > least[n]]
        widths[max(loose, key=lambda n: widths[n])] -= 1
    return widths


def _list(columns: list[Column], rows: list[list[Text]]) -> Table:
    """Return rows as paragraphs: a name or nothing first, then each value behind its heading."""
    headings = [f"{' '.join(column.text.split())} ".lstrip() for column in columns]
    if columns[0].align == "left":
        headings[0] = ""
    made = Table.grid(padding=(0, 1, 0, 0))
    for row in rows:
        pairs = zip(headings, row, strict=True)
        made.add_row("·", Text("; ").join(Text.assemble(*pair) for pair in pairs))
    return made


def _text(cell: str | Cell) -> Text:
    if isinstance(cell, Cell):
        return Text(cell.text, _STYLES.get(cell.look, ""))
    return Text(cell)
