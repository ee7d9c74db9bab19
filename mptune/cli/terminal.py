"""Prints the report's tables on a terminal, and JSON for programs.

A table that is too wide for the terminal is printed as a list: one paragraph for each row, every
value behind its heading, so that no number is ever broken over two lines. What the stream's
encoding cannot show is spelt out before anything is laid out.
"""

from __future__ import annotations

import json
import re
import sys
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from rich import box
from rich.cells import cell_len
from rich.console import Console
from rich.table import Table
from rich.text import Text

from mptune.cli.spelling import spelt
from mptune.escaping import printable
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

_on_terminal = sys.stdout is not None and sys.stdout.isatty()
console = Console(
    width=None if _on_terminal else _PIPE_WIDTH, markup=False, emoji=False, highlight=False
)


def as_json(values: dict[str, Any]) -> None:
    """Print one JSON object; what JSON cannot say (NaN, infinity) becomes null."""
    console.file.write(json.dumps(strict(values), allow_nan=False) + "\n")


def say(*parts: str | Cell) -> None:
    """Print a line, words with a look in it."""
    console.print(*(_text(part) for part in parts))


def verbatim(text: str) -> None:
    """Print a text of many lines with its lines as they are, for a file to take."""
    console.print(_text(text), soft_wrap=True)


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
        console.print(_text(printable(f"wrote {path}")), soft_wrap=True)


def show(*blocks: Block, ruled: bool = False) -> None:
    """Print the tables among a report's blocks, each under its title; the rest is for paper.

    ``ruled`` parts rows by lines, where their texts are long.
    """
    for one in blocks:
        if isinstance(one, Tabular):
            block = one.filled()
            columns = [replace(one, text=_spelt(one.text)) for one in block.columns]
            console.print(Text(_spelt(block.title), "bold"))
            console.print(_table(columns, [[*map(_text, row)] for row in block.rows], ruled))
            if block.legend:
                console.print(Text(_spelt(block.legend), "dim"))
            console.print()


def _table(columns: Sequence[Column], rows: list[list[Text]], ruled: bool) -> Table:
    room = console.width - _GAP * (len(columns) - 1)
    widths = _widths(columns, rows, room)
    if sum(widths) > room:
        return _list(columns, rows)
    made = Table(
        box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1, 0, 0), show_lines=ruled
    )
    for column, width in zip(columns, widths, strict=True):
        made.add_column(column.text, justify=column.align, width=width)
    for row in rows:
        made.add_row(*row)
    return made


def _widths(columns: Sequence[Column], rows: list[list[Text]], room: int) -> list[int]:
    """Return the columns' widths: the widest give way, but no word and no number is broken."""
    widths, least = [], []
    for n, column in enumerate(columns):
        texts = [column.text, *(row[n].plain for row in rows)]
        whole = texts[1:] if column.align == "right" else []
        words = [*whole, *(word for text in texts for word in _WORD.findall(text))]
        least.append(max(map(cell_len, words), default=0))
        widths.append(max(cell_len(line) for text in texts for line in text.split("\n")))
    while sum(widths) > room and widths != least:
        loose = [n for n, width in enumerate(widths) if width > least[n]]
        widths[max(loose, key=lambda n: widths[n])] -= 1
    return widths


def _list(columns: Sequence[Column], rows: list[list[Text]]) -> Table:
    """Return rows as paragraphs: a name or nothing first, then each value behind its heading."""
    headings = [f"{' '.join(column.text.split())} ".lstrip() for column in columns]
    if columns[0].align == "left":
        headings[0] = ""
    made = Table.grid(padding=(0, 1, 0, 0))
    for row in rows:
        pairs = zip(headings, row, strict=True)
        made.add_row(_spelt("·"), Text("; ").join(Text.assemble(*pair) for pair in pairs))
    return made


def _text(cell: str | Cell) -> Text:
    if isinstance(cell, Cell):
        return Text(_spelt(cell.text), _STYLES.get(cell.look, ""))
    return Text(_spelt(cell))


def _spelt(text: str) -> str:
    return spelt(printable(text, keep="\n"), console.encoding)
