"""Texts of files on their way into another language: one escaping per target, each an allowed set.

A study's title, a set's name and a folder's name are anybody's. What stands in the allowed set of a
target passes; all else is written in a form that cannot mean anything there. Nothing is looked for
that would have to be known to be dangerous.
"""

from __future__ import annotations

import hashlib
import string
from typing import Any, Final

_WORDS: Final = frozenset(" .,:;=+-_()[]<>%'\"!&@#|~^/") | frozenset("–—·…→←≤≥±×°∫√∞′″’‘“”ˆ̂")
_COMMENT: Final = _WORDS - frozenset("|~#@&")
_NAME: Final = frozenset(" .-_+,()")
_ASCII_STRING: Final = frozenset(string.ascii_letters + string.digits + " ._:+-")
_HTML: Final = frozenset(" \n.,:;=+-_()[]%!/|~^–—·…→≤≥±×°∫√∞′″’“”")
_BARE_KEY: Final = frozenset(string.ascii_letters + string.digits + "-_")
_LINE_LENGTH: Final = 1000  # characters: compilers need not take lines above 4095 bytes
_NAME_BYTES: Final = 80  # of a file's name: what is appended to it must fit into 255
_DIGITS: Final = 8
_UNPRINTABLE: Final = "\N{REPLACEMENT CHARACTER}"


def printable(text: str, *, keep: str = "") -> str:
    """Return a text in which all but printable characters, and those to keep, are marked as lost.

    Control and formatting characters, unassigned ones, and halves of pairs, as file names that are
    not UTF-8 have them, are not printable. So the text is UTF-8, and fit for XML, JSON and a
    terminal.
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c in keep else _UNPRINTABLE for c in text)


def printable_values(value: Any) -> Any:
    """Return JSON's values with every text in them printable, line ends kept."""
    if isinstance(value, dict):
        return {printable(key): printable_values(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [printable_values(inner) for inner in value]
    return printable(value, keep="\n") if isinstance(value, str) else value


def comment_text(text: str) -> str:
    r"""Return a line that is a comment's in C, Structured Text and TOML alike, and ends none.

    Letters and digits of any script and some signs pass. ``*`` is not among them, so that no
    comment of C or Structured Text begins or ends; neither are ``\``, ``?`` (trigraphs), braces,
    ``$`` and line ends.
    """
    line = "".join(c if c.isalnum() or c in _COMMENT else "_" for c in text[: _LINE_LENGTH + 1])
    return line if len(line) <= _LINE_LENGTH else line[: _LINE_LENGTH - 1] + "…"


def c_string(text: str) -> str:
    """Return a text for a string in C: letters, digits and ``._:+-`` of ASCII, and spaces."""
    return "".join(c if c in _ASCII_STRING else "_" for c in text[:_LINE_LENGTH])


def toml_key(text: str) -> str:
    """Return a text as one part of a dotted TOML key: bare, or as a string in quotation marks."""
    if text and all(c in _BARE_KEY for c in text):
        return text
    inside = (c if c.isalnum() or c in " .-_" else f"\\U{ord(c):08x}" for c in text)
    return f'"{"".join(inside)}"'


def html_text(text: str) -> str:
    """Return a text that is HTML's or XML's, between tags and in attributes.

    Letters, digits and harmless signs stand as they are, other printable ones as their numbers.
    """
    return "".join(
        c if c.isalnum() or c in _HTML else f"&#{ord(c)};" for c in printable(text, keep="\n")
    )


def figure_text(text: str) -> str:
    """Return a text as a figure shows it: no mark of mathematics, nothing that SVG cannot hold."""
    return printable(text).replace("\\", "\N{SET MINUS}").replace("$", r"\$")


def file_name(text: str) -> str:
    """Return the name under which a thing is kept: a file's, in an archive's, a model's.

    Letters and digits of any script, spaces and ``.-_+,()`` pass, within 80 bytes and neither
    hidden nor like an option. A name that had to be changed ends in some digits of the hash of what
    it was, so that two of them never meet in one file.
    """
    kept = "".join(c if c.isalnum() or c in _NAME else "_" for c in text).strip(" ").lstrip(".-")
    if kept and kept == text.rstrip(".") == text and len(kept.encode()) <= _NAME_BYTES:
        return kept
    original = hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()
    kept = kept.encode()[: _NAME_BYTES - 1 - _DIGITS].decode(errors="ignore")
    return f"{kept or 'study'}-{original[:_DIGITS]}"
