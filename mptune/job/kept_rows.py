"""The shapes of what commands keep for the report: rows of numbers and words, checked on reading.

Only what the report shows is asked for; further keys may stand beside it.
"""

from __future__ import annotations

from typing import Any, Final, Literal

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError


class _KeptRow(BaseModel):
    model_config = ConfigDict(strict=True)


class _Figures(_KeptRow):
    tracking_index_s: float | None
    k_i_pos: float | None
    load_step_m_per_n: float | None
    bandwidth_rad_s: float | None


class _Controller(_KeptRow):
    structure: Literal["own", "p", "pi", "pid", "eq22"]
    figures: _Figures
    velocity_worst_ratio: float
    position_worst_ratio: float
    status: str | None
    satisfied: bool


class _Point(_KeptRow):
    figures: _Figures
    converged: bool


class _Trial(_KeptRow):
    name: str
    reason: str = ""
    weights: dict[str, float | None] = {}
    energy_loss_j_per_mm: float | None = None
    performance_index_ms: float | None = None
    force_error_integral_kn2s: float | None = None
    valve_switches: float | None = None
    converter_peak_mm: float | None = None


_SHAPES: Final[dict[str, TypeAdapter[Any]]] = {
    "comparison": TypeAdapter(list[_Controller]),
    "front": TypeAdapter(list[_Point]),
    "weights": TypeAdapter(list[_Trial]),
}
_MOST: Final = 2000  # rows: some ten times what commands keep


def checked_rows(name: str, rows: Any) -> tuple[dict[str, Any], ...]:
    """Return the rows of ``comparison``, ``front`` or ``weights`` as they are.

    Raises
    ------
    ValueError
        If they are too many, or of another shape than the command of that name keeps.
    """
    if isinstance(rows, list) and len(rows) > _MOST:
        raise ValueError(f"has {len(rows)} rows, of which {_MOST} are shown at most")
    try:
        _SHAPES[name].validate_python(rows)
    except ValidationError as error:
        place = ".".join(map(str, error.errors()[0]["loc"]))
        raise ValueError(f"is of another shape, at rows.{place}") from error
    return tuple(rows)
