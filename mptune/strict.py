"""JSON has neither NaN nor infinity: what it cannot say becomes null."""

from __future__ import annotations

import math
from typing import Any


def strict(value: Any) -> Any:
    """Return dictionaries, lists and numbers as strict JSON holds them, None where not finite."""
    if isinstance(value, dict):
        return {key: strict(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [strict(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
