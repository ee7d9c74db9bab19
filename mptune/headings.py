"""Headings of columns, and channels as they are asked for: a name, and a unit behind it."""

from __future__ import annotations

import re
from functools import cache

from mptune.units import is_unit

_HEADING = re.compile(
    r"(?P<label>.*?)(?P<gap>\s*)(?P<bracket>[\[(])(?P<within>[^\[\]()]*)[\])]\s*", re.DOTALL
)
_INDEX = re.compile(r"\s*\d+\s*(,\s*\d+\s*)*")
_PLAIN = {"1", "-", "abs", "%", "db"}  # units of a plain number


@cache
def label_and_unit(text: str) -> tuple[str, str]:
    """Return name and unit of a column's heading, ``F_ref [kN]``; the unit may be missing.

    Round brackets may stand for square ones where a unit is in them: ``Force (filtered)`` is a
    name. Whole numbers that follow the name at once are an index, and part of it: ``u[1]``.
    """
    match = _HEADING.fullmatch(text)
    if match is None or (not match["gap"] and _INDEX.fullmatch(match["within"])):
        return text.strip(), ""
    unit = match["within"].strip()
    if match["bracket"] == "(" and unit.lower() not in _PLAIN and not is_unit(unit):
        return text.strip(), ""
    return match["label"].strip(), unit


def without_index(label: str, unit: str) -> tuple[str, str]:
    """Return name and unit of a column whose name is known, and no array's: ``inertia[1]``."""
    return (label.removesuffix("[1]"), "1") if label.endswith("[1]") else (label, unit)
