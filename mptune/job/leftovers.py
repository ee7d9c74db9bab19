"""What other commands have left in a study's folder, for the report.

::

    <out>/<study>/comparison.json    the controllers of ``tune --compare``
    <out>/<study>/front.json         the points of ``tune --front``
    <out>/<study>/margins.json       the points of ``tune --front N --along disk_margin``
    <out>/<study>/weights.json       the recommendation and the front of ``weights``
    <out>/<study>/systems.json       the runs and calibrated values of ``systems``
    <out>/<study>/studies.json       the rows of ``studies``, this one among others
    <out>/<study>/identification.nc  the panels of ``identify``

Each says for which model it was made. What belongs to another one is not taken. What cannot be
read, or is of another shape, is left out as well, and the report says so.
"""

from __future__ import annotations

import json
from functools import partial
from typing import TYPE_CHECKING, Any

from mptune.errors import InputError
from mptune.escaping import printable
from mptune.files import read_whole, write_whole
from mptune.identify.store import read_panels
from mptune.job.identify import figure_name
from mptune.job.kept_rows import checked_rows
from mptune.report.picture import LARGEST, safe_picture
from mptune.report.results import Leftovers

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from mptune.params.study import ResolvedStudy

_FIGURES = {
    "comparison": "controllers",
    "front": "front",
    "margins": "margins",
    "weights": "weights",
    "systems": "systems",
    "studies": "studies",
}
_LARGEST = 4_000_000  # bytes: some hundred times what commands keep


def keep(folder: Path, name: str, study: ResolvedStudy, rows: list[dict[str, Any]]) -> Path:
    """Write the rows of a comparison, a front or a search, with the model that they belong to."""
    values = {"study": study.name, "study_hash": study.hash(), "rows": rows}
    return write_whole(folder / f"{name}.json", json.dumps(values, indent=1) + "\n")


def leftovers(folder: Path, study: ResolvedStudy) -> Leftovers:
    """Return what the study's folder holds for this model, and what was left out of it."""
    left_out: list[str] = []

    def taken(name: str, read: Callable[[Path], Any], nothing: Any) -> Any:
        """Return what a file holds; nothing where it is not there or cannot be used."""
        path = folder / name
        try:
            return read(path) if path.is_file() else nothing
        except (InputError, OSError, ValueError) as error:
            reason = error.faults[0].rule if isinstance(error, InputError) else str(error)
            left_out.append(f"{name} was left out, for it {printable(reason)}.")
            return nothing

    model = study.hash()
    rows = {
        name: taken(f"{name}.json", partial(_rows, name=name, model=model), ()) for name in _FIGURES
    }
    panels = taken("identification.nc", lambda path: read_panels(path, model), ())
    names = [_FIGURES[name] for name, found in rows.items() if found]
    names += dict.fromkeys(figure_name(panel.valve_delay_s) for panel in panels)
    drawn = {
        name: taken(f"{name}.svg", lambda path: safe_picture(read_whole(path, LARGEST)), None)
        for name in names
    }
    figures = {name: svg for name, svg in drawn.items() if svg is not None}
    return Leftovers(
        rows["comparison"],
        rows["front"],
        rows["weights"],
        panels,
        figures,
        rows["systems"],
        rows["studies"],
        rows["margins"],
        tuple(left_out),
    )


def _rows(path: Path, name: str, model: str) -> tuple[dict[str, Any], ...]:
    """Return the rows of a file; none where it belongs to another model."""
    if path.stat().st_size > _LARGEST:
        raise ValueError(f"is larger than {_LARGEST / 1e6:g} MB")
    try:
        values = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise ValueError("is not JSON") from error
    made_for = values.get("study_hash") if isinstance(values, dict) else None
    if not isinstance(made_for, str):
        raise ValueError("is of another shape")  # noqa: TRY004 - of the file, not of an argument
    return checked_rows(name, values.get("rows")) if made_for == model else ()
