"""The parts of a report, as plain data that any template can print.

A section is a title and a list of blocks; a block is a dictionary with a ``kind``. Texts are never
markup: what a template prints, it prints as it stands. Two things alone are told apart, here and
not in the templates: symbols with a subscript in the report's own prose (``F_ref``), and the look
of a table's cell.
"""

from __future__ import annotations

import re
from dataclasses import asdict, dataclass
from typing import Any

Block = dict[str, Any]

_SYMBOL = re.compile(r"(?<![\w./])([^\W\d_])_([A-Za-z0-9]+(?:,[A-Za-z]+)*)(?![\w/(])")


@dataclass(frozen=True)
class Cell:
    """A cell whose text has a look: symbol, key, strong, good, bad or small."""

    text: str
    look: str


@dataclass(frozen=True)
class Column:
    """A column: heading, alignment, and share of the spare width (0 for as wide as its text)."""

    heading: str
    align: str = "left"
    share: float = 0


def right(*headings: str) -> list[Column]:
    """Return columns of numbers."""
    return [Column(heading, "right") for heading in headings]


def left(*headings: str) -> list[Column]:
    """Return columns of text."""
    return [Column(heading) for heading in headings]


def wide(heading: str, share: float = 1) -> Column:
    """Return a column of text that takes the spare width."""
    return Column(heading, share=share)


def prose(text: str) -> Block:
    """Return a paragraph of the report's own words."""
    return {"kind": "prose", "runs": runs(text)}


def note(text: str) -> Block:
    """Return a paragraph in small print."""
    return {"kind": "note", "runs": runs(text)}


def heading(text: str) -> Block:
    """Return a heading within a section."""
    return {"kind": "heading", "runs": runs(text)}


def figure(name: str, caption: str) -> Block:
    """Return a figure; it is left out where there is none of that name."""
    return {"kind": "figure", "name": name, "runs": runs(caption), "caption": caption}


def equations(*lines: str) -> Block:
    """Return lines of equations of ``equations.typ``; names on one line are set side by side."""
    return {"kind": "equations", "lines": [line.split() for line in lines]}


def page_break() -> Block:
    """Return the start of a new page, where there are pages."""
    return {"kind": "break"}


def table(columns: list[Column], rows: list[list[str | Cell]], *, keep: bool = False) -> Block:
    """Return a table; ``keep`` it on one page where it is short."""
    cells = [
        [asdict(cell) if isinstance(cell, Cell) else {"text": cell, "look": ""} for cell in row]
        for row in rows
    ]
    heads = [{**asdict(column), "runs": runs(column.heading)} for column in columns]
    return {"kind": "table", "columns": heads, "rows": cells, "keep": keep}


def section(title: str, *blocks: Block, new_page: bool = False) -> dict[str, Any]:
    """Return a section, where asked for on a page of its own."""
    return {"title": title, "runs": runs(title), "blocks": list(blocks), "new_page": new_page}


def symbol(text: str) -> Cell:
    """Return a symbol, its subscript after the first underscore."""
    return Cell(text, "symbol")


def verdict(text: str, *, good: bool) -> Cell:
    """Return a word in the colour of its verdict."""
    return Cell(text, "good" if good else "bad")


def runs(text: str) -> list[dict[str, Any]]:
    """Return the report's own words cut where a subscript begins and ends."""
    found: list[dict[str, Any]] = []
    last = 0
    for match in _SYMBOL.finditer(text):
        found.append({"text": text[last : match.end(1)], "sub": False})
        found.append({"text": match[2], "sub": True})
        last = match.end()
    found.append({"text": text[last:], "sub": False})
    return [run for run in found if run["text"]]
