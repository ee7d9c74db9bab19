"""What other commands have left in a study's folder, for the report.

::

    <out>/<study>/comparison.json    the controllers of ``tune --compare``
    <out>/<study>/front.json         the points of ``tune --front``
    <out>/<study>/weights.json       the recommendation and the front of ``weights``
    <out>/<study>/systems.json       the runs and calibrated values of ``systems``
    <out>/<study>/identification.nc  the panels of ``identify``

Each says for which model it was made. What belongs to another one is not taken, and neither is
what cannot be read: the report then does without.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from mptune.files import write_whole
from mptune.identify.store import read_panels
from mptune.job.identify import figure_name
from mptune.report.results import Leftovers

if TYPE_CHECKING:
    from pathlib import Path

    from mptune.params.study import ResolvedStudy

_FIGURES = {
    "comparison": "controllers",
    "front": "front",
    "weights": "weights",
    "systems": "systems",
}


def keep(folder: Path, name: str, study: ResolvedStudy, rows: list[dict[str, Any]]) -> Path:
    """Write the rows of a comparison, a front or a search, with the model that they belong to."""
    values = {"study": study.name, "study_hash": study.hash(), "rows": rows}
    return write_whole(folder / f"{name}.json", json.dumps(values, indent=1) + "\n")


def leftovers(folder: Path, study: ResolvedStudy) -> Leftovers:
    """Return what the study's folder holds for this model."""
    rows = {name: _rows(folder / f"{name}.json", study.hash()) for name in _FIGURES}
    names = [_FIGURES[name] for name, found in rows.items() if found]
    panels = read_panels(folder / "identification.nc", study.hash())
    names += dict.fromkeys(figure_name(panel.valve_delay_s) for panel in panels)
    paths = {name: folder / f"{name}.svg" for name in names}
    figures = {name: path.read_bytes() for name, path in paths.items() if path.is_file()}
    return Leftovers(
        rows["comparison"], rows["front"], rows["weights"], panels, figures, rows["systems"]
    )


def _rows(path: Path, study_hash: str) -> tuple[dict[str, Any], ...]:
    try:
        values = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return ()
    if not isinstance(values, dict) or values.get("study_hash") != study_hash:
        return ()
    return tuple(values.get("rows", ()))
