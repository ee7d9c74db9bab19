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
    from collections.abc import Iterable

    from mptune.report.results import Results

_FIGURES = ("Index\n[ms]", "K_I,pos\n[1/s²]", "Load step\n[mm/kN]", "Bandwidth\n[rad/s]")


def comparison(results: Results) -> Chapter | None:
    """Return P, PI and PID beside Eq. 22, where they were tuned."""
    if not results.kept.compared:
        return None
    table = controllers(results.kept.compared)
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
    if not results.kept.front:
        return None
    table = points(results.kept.front)
    return Chapter.of(
        table.title,
        Prose(
            "The least tracking index for each integral gain, from where tracking is best to the "
            "largest integral gain that the requirements allow. Each point is a local optimum."
        ),
        Figure("The front, and where the study's own gains lie.", "front"),
        table,
    )


def points(found: Iterable[dict[str, Any]], own: dict[str, float] | None = None) -> Tabular:
    """Return the front's points, as JSON has them, and the figures of the study's own gains."""
    rows: list[Row] = [
        [*_figures(point["figures"]), "converged" if point["converged"] else "not converged"]
        for point in found
    ]
    if own is not None:
        rows.append([*_figures(own), "study's own"])
    return Tabular("Tracking against disturbance", [*right(*_FIGURES), *left("Search")], rows)


def _figures(figures: dict[str, float]) -> list[str]:
    return [
        f"{1e3 * figures['tracking_index_s']:.2f}",
        f"{figures['k_i_pos']:.3g}",
        f"{1e6 * figures['load_step_m_per_n']:.3g}",
        f"{figures['bandwidth_rad_s']:.3g}",
    ]
