"""The force controller's weights: what was recommended, and the front (§5.4)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mptune.report.blocks import Cell, Column, figure, left, prose, right, section, table
from mptune.sim.merit import merit
from mptune.units import number
from mptune.weigh.trial import OBJECTIVES

if TYPE_CHECKING:
    from mptune.report.results import Results

_FIGURES = tuple((merit(key).title("\n"), key) for key in (*OBJECTIVES, "converter_peak_mm"))
_WEIGHTS = (
    ("W_sw\n[N]", "weight_switching_n"),
    ("W_loss\n[N/J]", "weight_loss_n_per_j"),
    ("W_conv\n[N s/m⁶]", "weight_converter_n_s_per_m6"),
)


def weights(results: Results) -> dict[str, Any] | None:
    """Return the weights searched, where they were."""
    found = results.leftovers.weights
    if not found:
        return None
    rows: list[list[str | Cell]] = [
        [
            one["name"],
            *(number(one["weights"][key], 3) for _, key in _WEIGHTS),
            *(number(one[key], 3) for _, key in _FIGURES),
        ]
        for one in found
    ]
    headings = [heading for heading, _ in (*_WEIGHTS, *_FIGURES)]
    columns: list[Column] = [*left("Weights"), *right(*headings)]
    reason = next((one["reason"] for one in found if "reason" in one), "")
    return section(
        "The force controller's weights",
        figure("weights", "The trials' figures, the front, and the study's own weights."),
        prose(
            "Mean over masses and seeds; the study's own and the recommended weights again, with "
            f"random numbers that the search has not seen. {reason}."
        ),
        table(columns, rows),
    )
