"""The parts that a report is made of, as plain data that PDF, HTML and terminal print alike.

A chapter is a title and blocks. Texts are never markup: what is printed, is printed as it stands.
Two things alone are told apart, here and not where they are printed: symbols with a subscript in
the report's own words (``F_ref``), and the look of a table's cell.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

NOTHING = "—"
"""What a cell says that has nothing to say."""

_SYMBOL = re.compile(r"(?<![\w./])([^\W\d_])_([A-Za-z0-9]+(?:,[A-Za-z]+)*)(?![\w/(])")


@dataclass(frozen=True)
class Cell:
    """A cell whose text has a look: symbol, key, strong, good, bad or small."""

    text: str
    look: str


Row = Sequence[str | Cell]


@dataclass(frozen=True)
class Words:
    """The report's own words, in which symbols get their subscript."""

    text: str

    @property
    def runs(self) -> list[dict[str, Any]]:
        """The text, cut where a subscript begins and ends."""
        found: list[dict[str, Any]] = []
        last = 0
        for match in _SYMBOL.finditer(self.text):
            found.append({"text": self.text[last : match.end(1)], "sub": False})
            found.append({"text": match[2], "sub": True})
            last = match.end()
        found.append({"text": self.text[last:], "sub": False})
        return [run for run in found if run["text"]]


class Prose(Words):
    """A paragraph."""


class Note(Words):
    """A paragraph in small print."""


class Heading(Words):
    """A heading within a chapter."""


@dataclass(frozen=True)
class Figure(Words):
    """A figure with its caption; it is left out where there is none of that name."""

    name: str


@dataclass(frozen=True)
class Equations:
    """Lines of equations of ``equations.typ``, by name; those on one line stand side by side."""

    lines: Sequence[Sequence[str]]


@dataclass(frozen=True)
class Break:
    """The start of a new page, where there are pages."""


@dataclass(frozen=True)
class Column(Words):
    """A column: its heading, its side, and how it shares the width.

    Attributes
    ----------
    align
        ``"left"`` or ``"right"``.
    share
        Share of the spare width; 0 for as wide as its text.
    detail
        Whether a summary does without it.
    """

    align: Literal["left", "right"] = "left"
    share: float = 0
    detail: bool = False


@dataclass(frozen=True)
class Tabular:
    """A table of texts.

    Attributes
    ----------
    title
        What it shows: above it on a terminal, and in a report where it is ``titled``.
    keep
        Whether it stays on one page.
    legend
        What its words and its dashes mean, below it in small print.
    """

    title: str
    columns: Sequence[Column]
    rows: Sequence[Row]
    keep: bool = True
    legend: str = ""

    def titled(self, *after: Block) -> list[Block]:
        """Return the table under its title, and what follows it; nothing where it has no rows."""
        return [Heading(self.title), self, *after] if self.rows else []

    def brief(self) -> Tabular:
        """Return the table without its columns of detail."""
        return self._with([n for n, column in enumerate(self.columns) if not column.detail])

    def filled(self) -> Tabular:
        """Return the table without those columns in which no row says anything."""
        texts = [
            [getattr(row[n], "text", row[n]) for row in self.rows] for n in range(len(self.columns))
        ]
        kept = [n for n, column in enumerate(texts) if not n or set(column) - {"", NOTHING}]
        return self._with(kept) if self.rows else self

    def _with(self, kept: Sequence[int]) -> Tabular:
        rows = [[row[n] for n in kept] for row in self.rows]
        return replace(self, columns=[self.columns[n] for n in kept], rows=rows)


Block = Words | Equations | Break | Tabular


@dataclass(frozen=True)
class Chapter(Words):
    """A title and blocks, where asked for on a page of its own."""

    blocks: Sequence[Block]
    new_page: bool = False

    @classmethod
    def of(cls, title: str, *blocks: Block, new_page: bool = False) -> Chapter:
        """Return a chapter of some blocks."""
        return cls(title, blocks, new_page)


@dataclass(frozen=True)
class FrontPage:
    """The verdict in a word, its reasons, what to mind, and tables."""

    about: Sequence[str]
    headline: str
    status: Sequence[str]
    warnings: Sequence[str]
    blocks: Sequence[Block]


@dataclass(frozen=True)
class Document:
    """Everything that is printed; ``running`` stands at the head of each page."""

    title: str
    running: str
    satisfied: bool
    front: FrontPage
    chapters: Sequence[Chapter]


def right(*headings: str, detail: bool = False) -> list[Column]:
    """Return columns of numbers."""
    return [Column(heading, "right", detail=detail) for heading in headings]


def left(*headings: str) -> list[Column]:
    """Return columns of text."""
    return [Column(heading) for heading in headings]


def wide(heading: str, share: float = 1, *, detail: bool = False) -> Column:
    """Return a column of text that takes the spare width."""
    return Column(heading, share=share, detail=detail)


def equations(*lines: str) -> Equations:
    """Return equations, the names on a line parted by spaces."""
    return Equations([line.split() for line in lines])


def symbol(text: str) -> Cell:
    """Return a symbol, its subscript after the first underscore."""
    return Cell(text, "symbol")


def verdict(text: str, *, good: bool) -> Cell:
    """Return a word in the colour of its verdict."""
    return Cell(text, "good" if good else "bad")


def plain(part: Any) -> dict[str, Any]:
    """Return a part as a dictionary for JSON, its ``kind`` and its words' ``runs`` with it."""
    values = {**vars(part), "kind": type(part).__name__.lower()}
    return values | ({"runs": part.runs} if isinstance(part, Words) else {})
