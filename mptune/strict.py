"""JSON has neither NaN nor infinity: what it cannot say becomes null."""

from __future__ import annotations

import math
from typing import Any


def strict(values: dict[str, Any]) -> dict[str, Any]:
    """Return values as strict JSON holds them: tuples as lists, None for what is not finite."""
    return {key: _sayable(value) for key, value in values.items()}


def _sayable(value: Any) -> Any:
    if isinstance(value, dict):
        return strict(value)
    if isinstance(value, list | tuple):
        return [_sayable(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
