"""Simpler controllers under the same requirements, and the front of tracking and disturbance."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mptune.report.blocks import (
    Chapter,
    Figure,
    Note,
    Prose,
    Row,
    Tabular,
    left,
    right,
    verdict,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from mptune.report.results import Results

_FORMS = (
    ("tracking_index_s", 1e3, ".2f"),
    ("k_i_pos", 1.0, ".3g"),
    ("load_step_m_per_n", 1e6, ".3g"),
    ("bandwidth_rad_s", 1.0, ".3g"),
)
_FIGURES = ("Index\n[ms]", "K_I,pos\n[1/s²]", "Load step\n[mm/kN]", "Bandwidth\n[rad/s]")


def comparison(results: Results) -> Chapter | None:
    """Return P, PI and PID beside Eq. 22, where they were tuned."""
    if not results.leftovers.compared:
        return None
    table = controllers(results.leftovers.compared)
    return Chapter.of(
        table.title,
        Figure(
            "Right-hand side of Eq. 21 for each controller above the family's error, and the worst "
            "performance index.",
            "controllers",
        ),
        table,
        Note(
            "Each is tuned with the same objective, requirements and family; bounds of gains that "
            "a structure does not have are not asked of it."
        ),
    )


def controllers(compared: Iterable[dict[str, Any]]) -> Tabular:
    """Return compared controllers with their figures, as JSON has them."""
    from mptune.tune.baselines import LABELS  # with all of the tuner, which a sweep does without

    rows: list[Row] = [
        [
            LABELS[one["structure"]],
            *_figures(one["figures"]),
            f"{one['velocity_worst_ratio']:.3f}",
            f"{one['position_worst_ratio']:.3f}",
            verdict(one["status"] or "not tuned", good=one["satisfied"]),
        ]
        for one in compared
    ]
    detail = right(*_FIGURES[1:], "Eq. 17", "Eq. 21", detail=True)
    columns = [*left("Controller"), *right(_FIGURES[0]), *detail, *left("Status")]
    return Tabular("Controllers under the same requirements", columns, rows)


def front(results: Results) -> Chapter | None:
    """Return the Pareto front of tracking against disturbance, where it was run."""
    if not results.leftovers.front:
        return None
    table = points(results.leftovers.front)
    return Chapter.of(
        table.title,
        Prose(
            "The least tracking index for each integral gain, from where tracking is best to the "
            "largest integral gain that the requirements allow. Each point is a local optimum."
        ),
        Figure("The front, and where the study's own gains lie.", "front"),
        table,
    )


def points(
    found: Iterable[dict[str, Any]], own: Mapping[str, float | None] | None = None
) -> Tabular:
    """Return the front's points, as JSON has them, and the figures of the study's own gains."""
    rows: list[Row] = [
        [*_figures(point["figures"]), "converged" if point["converged"] else "not converged"]
        for point in found
    ]
    if own is not None:
        rows.append([*_figures(own), "study's own"])
    return Tabular("Tracking against disturbance", [*right(*_FIGURES), *left("Search")], rows)


def _figures(figures: Mapping[str, float | None]) -> list[str]:
    """Return the cells; a dash where a figure is not finite, as of a loop that runs away."""
    cells = []
    for key, factor, form in _FORMS:
        value = figures[key]
        cells.append("—" if value is None else f"{factor * value:{form}}")
    return cells
