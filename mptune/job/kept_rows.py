"""The shapes of what commands keep for the report: rows of numbers and words, checked on reading.

Only what the report shows is asked for; further keys may stand beside it.
"""

from __future__ import annotations

from typing import Annotated, Any, Final, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError


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


class _MarginFigures(_KeptRow):
    tracking_index_s: float | None
    disk_margin: float
    peak_compliance_m_per_n: float | None


class _MarginPoint(_KeptRow):
    figures: _MarginFigures
    disk_margin_guaranteed: float | None
    noise_force_n: float | None
    performance_index_ms: float | None
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


class _Run(_KeptRow):
    kind: Literal["run"]
    system: str
    title: str
    boundary: str
    controller: str
    gains: str
    best: bool
    mass_kg: float
    stable: bool
    performance_index_ms: float | None
    energy_loss_j_per_mm: float | None
    force_error_integral_kn2s: float | None
    valve_switches: float | None
    energy_residual: float | None
    reference_index_ms: float | None
    returned_j_per_mm: float | None


class _StudyRow(_KeptRow):
    study: str
    gains: Literal["own", "tuned"]
    mass_kg: float | None
    stable: bool | None
    performance_index_ms: float | None
    energy_loss_j_per_mm: float | None
    force_error_integral_kn2s: float | None
    valve_switches: float | None
    final_error_mm: float | None
    gain_margin: float | None
    disk_margin: float | None
    disk_margin_guaranteed: float | None
    noise_force_n: float | None


_Three = Annotated[list[float | None], Field(min_length=3, max_length=3)]


class _Calibrated(_KeptRow):
    kind: Literal["calibrated"]
    key: str
    value: float
    unit: str
    source: str
    change: float
    performance_index_ms: _Three
    energy_loss_j_per_mm: _Three


_SystemsRow = Annotated[_Run | _Calibrated, Field(discriminator="kind")]
_SHAPES: Final[dict[str, TypeAdapter[Any]]] = {
    "comparison": TypeAdapter(list[_Controller]),
    "front": TypeAdapter(list[_Point]),
    "weights": TypeAdapter(list[_Trial]),
    "systems": TypeAdapter(list[_SystemsRow]),
    "margins": TypeAdapter(list[_MarginPoint]),
    "studies": TypeAdapter(list[_StudyRow]),
}
_MOST: Final = 2000  # rows: some ten times what commands keep


def checked_rows(name: str, rows: Any) -> tuple[dict[str, Any], ...]:
    """Return the rows of one of ``comparison``, ``front``, ``margins``, ``weights`` and so on.

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
