"""Sections of the README where the guide asks for them, so that nothing is written twice.

A line ``[[README: Measured force loops]]`` in a page becomes that section without its heading, and
``[[README]]`` what stands before the first one. Links to files of the repository follow.
"""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
_ASKED = re.compile(r"^\[\[README(?:: (?P<heading>.+))?\]\]$", re.MULTILINE)
_PLACES = {
    "docs/sample/": "sample/",
    "SECURITY.md": "security.md",
}


def on_page_markdown(markdown: str, **_: object) -> str:
    """Put the README's sections in.

    Raises
    ------
    KeyError
        If the README has no such section.
    """
    return _ASKED.sub(lambda asked: _sections()[asked["heading"] or ""], markdown)


def _sections() -> dict[str, str]:
    """Return the text below each heading of the second order; what stands before them under ""."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    for here, there in _PLACES.items():
        text = text.replace(f"]({here}", f"]({there}")
    parts = re.split(r"^## (.+)$", text.split("\n", 1)[1], flags=re.MULTILINE)
    return {"": parts[0], **dict(zip(parts[1::2], parts[2::2], strict=True))}
