"""The force controller's weights: what was recommended, and the front (§5.4)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mptune.report.blocks import Chapter, Figure, Prose, Row, Tabular, left, right
from mptune.sim.merit import merit
from mptune.units import number
from mptune.weigh.trial import OBJECTIVES

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mptune.report.results import Results

_WEIGHTS = (
    ("W_sw\n[N]", "weight_switching_n", 1.0),
    ("W_loss\n[N/J]", "weight_loss_n_per_j", 1.0),
    ("W_conv\n[N s/m⁶]", "weight_converter_n_s_per_m6", 1.0),
    ("T_S\n[ms]", "sampling_period_s", 1e3),
)
_FIGURES = tuple((merit(key).title("\n"), key) for key in (*OBJECTIVES, "converter_peak_mm"))


def weights(results: Results) -> Chapter | None:
    """Return the weights searched, where they were."""
    found = results.leftovers.weights
    if not found:
        return None
    reason = next((one["reason"] for one in found if "reason" in one), "")
    table = trials("The force controller's weights", found)
    return Chapter.of(
        table.title,
        Figure("The trials' figures, the front, and the study's own weights.", "weights"),
        Prose(
            "Mean over masses and seeds; the study's own and the recommended weights again, with "
            f"random numbers that the search has not seen. {reason}."
        ),
        table,
    )


def trials(title: str, found: Iterable[dict[str, Any]]) -> Tabular:
    """Return weights and figures, as JSON has them, by ``name``; empty where one has none."""
    rows: list[Row] = [
        [
            one["name"],
            *(_text(factor, one.get("weights", {}).get(key)) for _, key, factor in _WEIGHTS),
            *(_text(1.0, one.get(key)) for _, key in _FIGURES),
        ]
        for one in found
    ]
    headings = [one[0] for one in _WEIGHTS] + [one[0] for one in _FIGURES]
    return Tabular(title, [*left("Weights"), *right(*headings)], rows, keep=False)


def _text(factor: float, value: float | None) -> str:
    return "" if value is None else number(factor * value, 3)
