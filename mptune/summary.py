"""How results show themselves: in a few lines at the prompt, as a table in a notebook.

Both are made of the same facts: one line in words, the ``headline``, and one per field. Arrays are
shown by shape and range, results within a result by their own headlines, so that nothing grows with
the number of plants, frequencies or runs.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import PurePath
from typing import Any

import numpy as np

from mptune.escaping import html_text

LINES = 30
"""No result shows itself in more lines than these."""

_WIDTH = 100  # of a fact's text
_LISTED = 6  # results within a field
_FEW = 8  # plain values within a field


class Summarised:
    """A result whose ``repr`` is short. A data class among these is made with ``repr=False``."""

    __slots__ = ()

    @property
    def headline(self) -> str:
        """The result in one line."""
        return type(self).__name__

    def __repr__(self) -> str:
        """Return the headline and a line per field, ``LINES`` lines at most."""
        return _text(self.headline, _facts(self))

    def _repr_html_(self) -> str:
        """Return the same as a table for notebooks."""
        rows = "".join(
            f"<tr><th>{html_text(name)}</th><td>{html_text(text)}</td></tr>"
            for name, text in _facts(self)
        )
        return f"<table><caption>{html_text(_cut(self.headline))}</caption>{rows}</table>"


def tuple_text(values: Any) -> str:
    """Return a named tuple of arrays as ``repr`` shows it, a line per field."""
    return _text(type(values).__name__, _facts(values))


def _text(headline: str, facts: list[tuple[str, str]]) -> str:
    width = max((len(name) for name, _ in facts), default=0)
    lines = [_cut(headline), *(f"  {name:<{width}}  {text}".rstrip() for name, text in facts)]
    if len(lines) > LINES:
        lines = [*lines[: LINES - 1], f"  … {len(lines) - LINES + 1} lines more"]
    return "\n".join(lines)


def _facts(result: Any) -> list[tuple[str, str]]:
    """Return name and text of every field; further texts of a field have no name."""
    facts = []
    for name in _names(result):
        first, *others = _texts(getattr(result, name))
        facts.append((name, _cut(first)))
        facts += [("", _cut(text)) for text in others]
    return facts


def _names(result: Any) -> list[str]:
    """Return the fields of a data class, a named tuple or a section; a plain object has none."""
    if dataclasses.is_dataclass(result):
        names = [field.name for field in dataclasses.fields(result)]
    else:
        names = list(getattr(result, "_fields", ()) or getattr(type(result), "model_fields", ()))
    return [name for name in names if not name.startswith("_")]


def _texts(value: Any) -> list[str]:
    """Return what a field holds: one text, or several where it holds several results."""
    if isinstance(value, tuple | list) and not hasattr(value, "_fields"):
        return _listed(list(value))
    return [_brief(value)]


def _listed(values: list[Any]) -> list[str]:
    if not values:
        return ["none"]
    if all(_is_plain(value) for value in values):
        shown = ", ".join(_plain(value) for value in values[:_FEW])
        return [shown + (f", … ({len(values)})" if len(values) > _FEW else "")]
    shown_lines = [_brief(value) for value in values[:_LISTED]]
    if len(values) > _LISTED:
        shown_lines.append(f"… and {len(values) - _LISTED} more")
    return shown_lines


def _brief(value: Any) -> str:
    """Return any value in one line."""
    if isinstance(value, Summarised):
        return value.headline
    if _is_plain(value):
        return _plain(value)
    if isinstance(value, np.ndarray):
        return _array(value)
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {_brief(item)}" for name, item in value.items()) or "none"
    return _of_parts(value)


def _of_parts(value: Any) -> str:
    """Return a small object by its fields, anything else by its kind."""
    fields = {name: getattr(value, name) for name in _names(value)}
    kind = getattr(value, "__name__", None) or type(value).__name__
    if fields and all(_is_plain(field) for field in fields.values()):
        return ", ".join(f"{name} {_plain(field)}" for name, field in fields.items())
    if fields and all(isinstance(field, np.ndarray) for field in fields.values()):
        return f"{kind}, {next(iter(fields.values())).shape} each"
    return (
        f"{len(value)} × {type(value[0]).__name__}"
        if isinstance(value, tuple) and value
        else str(kind)
    )


def _array(values: np.ndarray[Any, Any]) -> str:
    """Return shape and range of an array."""
    text = f"{values.shape} {values.dtype}"
    if values.size == 0 or values.dtype.kind not in "biuf":
        return text
    if values.dtype.kind == "b":
        return f"{text}, {int(values.sum())} true"
    finite = values[np.isfinite(values)]
    if not finite.size:
        return f"{text}, none finite"
    text += f", {_plain(finite.min().item())} … {_plain(finite.max().item())}"
    return text + (f", {values.size - finite.size} not finite" if finite.size < values.size else "")


def _is_plain(value: Any) -> bool:
    return value is None or isinstance(value, str | int | float | complex | PurePath)


def _plain(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    return "—" if value is None or value == "" else str(value)


def _cut(text: str) -> str:
    """Return a text as one line of bounded length."""
    line = " ".join(text.split())
    return line if len(line) <= _WIDTH else f"{line[: _WIDTH - 1]}…"
