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


def margins(results: Results) -> Chapter | None:
    """Return the front of tracking against disk margin, where it was run."""
    if not results.leftovers.margins:
        return None
    table = margin_points(results.leftovers.margins)
    return Chapter.of(
        table.title,
        Prose(
            "The least tracking index for each disk margin asked of F_ref as it runs. Each point "
            "is a local optimum on the grid, which can only miss worse plants; what the whole box "
            "keeps for certain stands beside it. Indices of the machine: means over its movement "
            "sets, of each mass over all its cases, and of the worst case."
        ),
        Figure("What a disk margin costs.", "margins"),
        table,
    )


def margin_points(found: Iterable[dict[str, Any]]) -> Tabular:
    """Return the points of the front over disk margins, as JSON has them."""
    rows: list[Row] = [
        [
            _cell(one["figures"]["disk_margin"], 1.0, ".3f"),
            _cell(one["disk_margin_guaranteed"], 1.0, ".3f"),
            _cell(one["figures"]["tracking_index_s"], 1e3, ".2f"),
            _by_mass(one.get("by_mass", ())),
            _cell(one["performance_index_ms"], 1.0, ".2f"),
            _cell(one["noise_force_n"], 1.0, ".0f"),
            _cell(one["figures"]["peak_compliance_m_per_n"], 1e6, ".3f"),
            "converged" if one["converged"] else "not converged",
        ]
        for one in found
    ]
    figures = (
        "Disk margin\ngrid",
        "guaran-\nteed",
        "Index\n[ms]",
        "machine, mean of\neach mass [ms]",
    )
    columns = [
        *right(*figures, "worst case\n[ms]", "Noise\n[N]", "Compliance\n[mm/kN]"),
        *left("Search"),
    ]
    return Tabular("Tracking against disk margin", columns, rows)


def _by_mass(found: Iterable[Mapping[str, float | None]]) -> str:
    """Return the machine's mean index on each mass, masses rising; a dash where it did not run."""
    return " / ".join(_cell(one["performance_index_ms"], 1.0, ".2f") for one in found) or "—"


def _figures(figures: Mapping[str, float | None]) -> list[str]:
    """Return the cells; a dash where a figure is not finite, as of a loop that runs away."""
    cells = []
    for key, factor, form in _FORMS:
        cells.append(_cell(figures[key], factor, form))
    return cells


def _cell(value: float | None, factor: float, form: str) -> str:
    return "—" if value is None else f"{factor * value:{form}}"
