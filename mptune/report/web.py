"""The same report for the browser: one HTML file that needs no network and runs no script.

Figures and typeset equations stand in it as SVG. Every text is escaped: a study's title that looks
like markup is printed as it stands.
"""

from __future__ import annotations

import re
from importlib import resources
from typing import TYPE_CHECKING

from mptune.escaping import html_text
from mptune.report.blocks import (
    Cell,
    Equations,
    Figure,
    Heading,
    Note,
    Prose,
    Tabular,
    Words,
)
from mptune.report.pdf import compiled

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from mptune.report.blocks import Block, Document

_FORMULAS, _EQUATIONS, _STYLE = "formulas.typ", "equations.typ", "report.css"
_NUMBERED = re.compile(r"eq(\d+)")
_PARAGRAPHS: dict[type, str] = {Prose: "p", Note: 'p class="note"', Heading: "h3"}
_HARD = "\N{NO-BREAK SPACE}"
_SHORT = 16  # characters of a cell that stays in one line
_UNIT = r"(?:[kMG]?N|[µmcdk]?m|m?s|k?g|t|[kM]?Pa|k?J|l|rad|°|%|1)"
_UNITS = re.compile(rf"[\d.)] {_UNIT}[²³⁴⁵⁶]?(?:[ /·]{_UNIT}[²³⁴⁵⁶]?)*(?![\w])")
_TAGS = {"key": "code", "strong": "strong", "small": "small"}


def web_page(document: Document, figures: Mapping[str, bytes]) -> str:
    """Return the report for the browser, its figures from SVG bytes by name.

    Raises
    ------
    OutputError
        If the equations do not compile.
    """
    drawn = {name: _inline(svg, name) for name, svg in figures.items()}
    pages = compiled((_FORMULAS, _EQUATIONS), {}, "svg")
    for name, svg in zip(_names_of_equations(), pages, strict=True):
        drawn[name] = _inline(svg, name)
    return _page(document, drawn)


def _names_of_equations() -> list[str]:
    """Return the names in ``equations.typ``, in the order of the pages of ``formulas.typ``."""
    text = resources.files("mptune.report").joinpath(_EQUATIONS).read_text(encoding="utf-8")
    return sorted(re.findall(r"^  (\w+): \(", text, re.MULTILINE))


def _inline(svg: bytes, name: str) -> str:
    """Return an SVG as an element whose identifiers are its own within the page."""
    text = svg.decode("utf-8")
    text = text[text.index("<svg") :]
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = re.sub(r'href="#', f'href="#{name}-', text)
    return re.sub(r"url\(#", f"url(#{name}-", text)


def _page(document: Document, drawn: Mapping[str, str]) -> str:
    style = resources.files("mptune.report").joinpath(_STYLE).read_text(encoding="utf-8")
    title, front = html_text(document.title), document.front
    verdict = "good" if document.satisfied else "bad"
    about = "<br>".join(map(html_text, front.about))
    status = "".join(f"<p>{html_text(line)}</p>" for line in front.status)
    warnings = "".join(
        f'<p class="mind"><strong>Mind:</strong> {html_text(one)}</p>' for one in front.warnings
    )
    contents = "".join(
        f'<li><a href="#section-{n}">{_words(one)}</a></li>'
        for n, one in enumerate(document.chapters, 1)
    )
    body = "".join(
        f'<section id="section-{n}"><h2>{n} {_words(one)}</h2>\n'
        f"{_blocks(one.blocks, drawn)}</section>\n"
        for n, one in enumerate(document.chapters, 1)
    )
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
{style}</style>
</head>
<body>
<header><h1>{title}</h1><p>{about}</p></header>
<div class="verdict {verdict}"><h2>{html_text(front.headline)}</h2>{status}</div>
{warnings}
{_blocks(front.blocks, drawn)}
<nav><h3>Contents</h3><ol>{contents}</ol></nav>
{body}</body>
</html>
"""


def _blocks(blocks: Iterable[Block], drawn: Mapping[str, str]) -> str:
    return "".join(f"{_block(block, drawn)}\n" for block in blocks)


def _block(block: Block, drawn: Mapping[str, str]) -> str:
    match block:
        case Tabular():
            return _table(block)
        case Equations():
            return "".join(_equation(name, drawn[name]) for line in block.lines for name in line)
        case Figure():
            return _figure(block, drawn[block.name])
        case Words():
            tag = _PARAGRAPHS[type(block)]
            return f"<{tag}>{_words(block)}</{tag.split()[0]}>"
    return ""  # a page's end


def _figure(figure: Figure, picture: str) -> str:
    """Return a figure that a click opens as large as the window, by its address alone."""
    name = html_text(figure.name)
    return (
        f'<div id="at-{name}"><figure id="figure-{name}">'
        f'<a href="#figure-{name}" title="open large">{picture}</a>'
        f'<a class="back" href="#at-{name}">× back to the page</a>'
        f"<figcaption>{_words(figure)}</figcaption></figure></div>"
    )


def _equation(name: str, picture: str) -> str:
    numbered = _NUMBERED.fullmatch(name)
    label = f"<span>(Eq. {int(numbered[1])})</span>" if numbered else ""
    return f'<div class="equation">{picture}{label}</div>'


def _table(table: Tabular) -> str:
    sides = [column.align for column in table.columns]
    heads = "".join(f'<th class="{column.align}">{_words(column)}</th>' for column in table.columns)
    rows = "".join(
        "<tr>"
        + "".join(
            f'<td class="{side}">{_cell(cell)}</td>' for side, cell in zip(sides, row, strict=True)
        )
        + "</tr>\n"
        for row in table.rows
    )
    legend = f'<p class="note">{_words(Note(table.legend))}</p>' if table.legend else ""
    made = f"<table><thead><tr>{heads}</tr></thead>\n{rows}</table>"
    return f'<div class="wide">{made}</div>{legend}'


def _cell(cell: str | Cell) -> str:
    if not isinstance(cell, Cell):
        return _unbroken(html_text(cell))
    text = html_text(cell.text)
    if cell.look == "symbol":
        base, _, below = text.partition("_")
        return base + (f"<sub>{below}</sub>" if below else "")
    if cell.look != "key":
        text = _unbroken(text)
    if cell.look in {"good", "bad"}:
        return f'<strong class="{cell.look}">{text}</strong>'
    tag = _TAGS[cell.look]
    return f"<{tag}>{text}</{tag}>"


def _unbroken(text: str) -> str:
    """Return a cell whose units stay with their numbers; a short one stays in one line."""
    if len(text) <= _SHORT:
        return text.replace(" ", _HARD)
    return _kept(text)


def _kept(text: str) -> str:
    """Return a text in which no unit is torn from its number."""
    return _UNITS.sub(lambda found: found[0].replace(" ", _HARD), text)


def _words(words: Words) -> str:
    return "".join(
        f"<sub>{html_text(run['text'])}</sub>" if run["sub"] else _kept(html_text(run["text"]))
        for run in words.runs
    )
