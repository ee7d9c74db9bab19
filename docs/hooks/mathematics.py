"""Equations as MathML, which browsers draw by themselves: no script, nothing from the network."""

from __future__ import annotations

import html
import re

from latex2mathml.converter import convert

_EQUATION = re.compile(
    r'<(?P<tag>span|div) class="arithmatex">\\(?:\(|\[)(?P<tex>.*?)\\(?:\)|\])</(?P=tag)>',
    re.DOTALL,
)


def on_page_content(content: str, **_: object) -> str:
    """Replace what the Markdown extension has marked as TeX."""
    return _EQUATION.sub(_converted, content)


def _converted(found: re.Match[str]) -> str:
    display = "block" if found["tag"] == "div" else "inline"
    tag = found["tag"]
    mathml = convert(html.unescape(found["tex"]).strip(), display=display)
    return f'<{tag} class="equation">{mathml}</{tag}>'
