"""Simpler controllers under the same requirements, and the front of tracking and disturbance."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mptune.report.blocks import (
    Cell,
    Column,
    figure,
    left,
    note,
    prose,
    right,
    section,
    table,
    verdict,
)
from mptune.tune.baselines import LABELS

if TYPE_CHECKING:
    from mptune.report.results import Results

_FORMS = (
    ("tracking_index_s", 1e3, ".2f"),
    ("k_i_pos", 1.0, ".3g"),
    ("load_step_m_per_n", 1e6, ".3g"),
    ("bandwidth_rad_s", 1.0, ".3g"),
)
_FIGURES = ("Index\n[ms]", "K_I,pos\n[1/s²]", "Load step\n[mm/kN]", "Bandwidth\n[rad/s]")


def comparison(results: Results) -> dict[str, Any] | None:
    """Return P, PI and PID beside Eq. 22, where they were tuned."""
    if not results.leftovers.compared:
        return None
    rows: list[list[str | Cell]] = [
        [
            LABELS[one["structure"]],
            *_figures(one["figures"]),
            f"{one['velocity_worst_ratio']:.3f}",
            f"{one['position_worst_ratio']:.3f}",
            verdict(one["status"] or "not tuned", good=one["satisfied"]),
        ]
        for one in results.leftovers.compared
    ]
    columns: list[Column] = [*left("Controller"), *right(*_FIGURES, "Eq. 17", "Eq. 21")]
    return section(
        "Controllers under the same requirements",
        figure(
            "controllers",
            "Right-hand side of Eq. 21 for each controller above the family's error, and the worst "
            "performance index.",
        ),
        table([*columns, *left("Status")], rows, keep=True),
        note(
            "Each is tuned with the same objective, requirements and family; bounds of gains that "
            "a structure does not have are not asked of it."
        ),
    )


def front(results: Results) -> dict[str, Any] | None:
    """Return the Pareto front of tracking against disturbance, where it was run."""
    if not results.leftovers.front:
        return None
    rows: list[list[str | Cell]] = [
        [*_figures(point["figures"]), "converged" if point["converged"] else "not converged"]
        for point in results.leftovers.front
    ]
    return section(
        "Tracking against disturbance",
        prose(
            "The least tracking index for each integral gain, from where tracking is best to the "
            "largest integral gain that the requirements allow. Each point is a local optimum."
        ),
        figure("front", "The front, and where the study's own gains lie."),
        table([*right(*_FIGURES), *left("Search")], rows, keep=True),
    )


def _figures(figures: dict[str, float | None]) -> list[str]:
    """Return the cells; a dash where a figure is not finite, as of a loop that runs away."""
    cells = []
    for key, factor, form in _FORMS:
        value = figures[key]
        cells.append("—" if value is None else f"{factor * value:{form}}")
    return cells
