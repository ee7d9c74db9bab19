"""The same report for the browser: one HTML file that needs no network and runs no script.

Figures and typeset equations stand in it as SVG. Every text is escaped: a study's title that looks
like markup is printed as it stands.
"""

from __future__ import annotations

import re
from html import escape
from importlib import resources
from typing import TYPE_CHECKING, Any

from mptune.files import write_whole
from mptune.report.pdf import compiled

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from mptune.report.blocks import Block

_FORMULAS, _EQUATIONS, _STYLE = "formulas.typ", "equations.typ", "report.css"
_NUMBERED = re.compile(r"eq(\d+)")
_TAGS = {
    "key": "code",
    "strong": "strong",
    "small": "small",
}


def write_html(path: str | Path, document: Mapping[str, Any], figures: Mapping[str, bytes]) -> Path:
    """Write the report for the browser, whole or not at all.

    Parameters
    ----------
    path
        The HTML file.
    document
        What it says, see ``mptune.report.content``.
    figures
        SVG bytes by name.

    Raises
    ------
    OutputError
        If the file cannot be written, or the equations do not compile.
    """
    drawn = {name: _inline(svg, name) for name, svg in figures.items()}
    pages = compiled(path, (_FORMULAS, _EQUATIONS), {}, "svg")
    for name, svg in zip(_names_of_equations(), pages, strict=True):
        drawn[name] = _inline(svg, name)
    return write_whole(path, _page(document, drawn))


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


def _page(document: Mapping[str, Any], drawn: Mapping[str, str]) -> str:
    style = resources.files("mptune.report").joinpath(_STYLE).read_text(encoding="utf-8")
    title, front = escape(document["title"]), document["front"]
    stamp = f"mptune {document['version']} · {document['date']} · model {document['hash'][:16]}"
    sections = document["sections"]
    verdict = "good" if document["satisfied"] else "bad"
    status = "".join(f"<p>{escape(line)}</p>" for line in front["status"])
    warnings = "".join(
        f'<p class="mind"><strong>Mind:</strong> {escape(one)}</p>' for one in front["warnings"]
    )
    contents = "".join(
        f'<li><a href="#section-{n}">{_words(one["runs"])}</a></li>'
        for n, one in enumerate(sections, 1)
    )
    body = "".join(
        f'<section id="section-{n}"><h2>{n} {_words(one["runs"])}</h2>\n'
        f"{_blocks(one['blocks'], drawn)}</section>\n"
        for n, one in enumerate(sections, 1)
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
<header><h1>{title}</h1><p>{escape(front["about"])}<br>{escape(stamp)}</p></header>
<div class="verdict {verdict}"><h2>{escape(front["headline"])}</h2>{status}</div>
{warnings}
{_blocks(front["blocks"], drawn)}
<nav><h3>Contents</h3><ol>{contents}</ol></nav>
{body}</body>
</html>
"""


def _blocks(blocks: Iterable[Block], drawn: Mapping[str, str]) -> str:
    return "".join(f"{_block(block, drawn)}\n" for block in blocks)


def _block(block: Block, drawn: Mapping[str, str]) -> str:
    kind = block["kind"]
    if kind == "table":
        return _table(block)
    if kind == "figure":
        picture, caption = drawn[block["name"]], _words(block["runs"])
        return f"<figure>{picture}<figcaption>{caption}</figcaption></figure>"
    if kind == "equations":
        names = [name for line in block["lines"] for name in line]
        return "".join(_equation(name, drawn[name]) for name in names)
    if kind == "break":
        return ""
    tag = {"prose": "p", "note": 'p class="note"', "heading": "h3"}[kind]
    return f"<{tag}>{_words(block['runs'])}</{tag.split()[0]}>"


def _equation(name: str, picture: str) -> str:
    numbered = _NUMBERED.fullmatch(name)
    label = f"<span>(Eq. {int(numbered[1])})</span>" if numbered else ""
    return f'<div class="equation">{picture}{label}</div>'


def _table(block: Block) -> str:
    heads = "".join(
        f'<th class="{column["align"]}">{_words(column["runs"])}</th>'
        for column in block["columns"]
    )
    rows = "".join(
        "<tr>"
        + "".join(
            f'<td class="{column["align"]}">{_cell(cell)}</td>'
            for column, cell in zip(block["columns"], row, strict=True)
        )
        + "</tr>\n"
        for row in block["rows"]
    )
    return f'<div class="wide"><table><thead><tr>{heads}</tr></thead>\n{rows}</table></div>'


def _cell(cell: Mapping[str, str]) -> str:
    text, look = cell["text"], cell["look"]
    if look == "symbol":
        base, _, below = text.partition("_")
        return escape(base) + (f"<sub>{escape(below)}</sub>" if below else "")
    if look in {"good", "bad"}:
        return f'<strong class="{look}">{escape(text)}</strong>'
    tag = _TAGS.get(look)
    return f"<{tag}>{escape(text)}</{tag}>" if tag else escape(text)


def _words(runs: Iterable[Mapping[str, Any]]) -> str:
    return "".join(
        f"<sub>{escape(run['text'])}</sub>" if run["sub"] else escape(run["text"]) for run in runs
    )
