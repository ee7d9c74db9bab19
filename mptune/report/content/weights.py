"""The force controller's weights: what was recommended, and the front (§5.4)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mptune.report.blocks import Chapter, Figure, Prose, Row, Tabular, left, right
from mptune.sim.merit import merit
from mptune.units import number
from mptune.weigh.trial import OBJECTIVES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.report.results import Results

_CONVERTER, _PEAK = "weight_converter_n_s_per_m6", "converter_peak_mm"
_WEIGHTS = (
    ("W_sw\n[N]", "weight_switching_n", 1.0),
    ("W_loss\n[N/J]", "weight_loss_n_per_j", 1.0),
    ("W_conv\n[N s/m⁶]", _CONVERTER, 1.0),
    ("T_S\n[ms]", "sampling_period_s", 1e3),
    ("f_0\n[N]", "error_width_n", 1.0),
    ("n\n[-]", "candidates", 1.0),
    ("W_cm\n[N/MPa]", "weight_common_mode_n_per_pa", 1e6),
    ("W_comp\n[N/J]", "weight_compression_n_per_j", 1.0),
)
_ALWAYS = 4  # of these; the others where they were searched
_FIGURES = tuple((merit(key).title("\n"), key) for key in (*OBJECTIVES, _PEAK))


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


def trials(title: str, found: Sequence[dict[str, Any]]) -> Tabular:
    """Return weights and figures, as JSON has them, by ``name``; empty where one has none.

    What converters and what the search have nothing to do with is left out.
    """
    left_out = set() if any(one.get(_PEAK) for one in found) else {_CONVERTER, _PEAK}
    for _, key, _ in _WEIGHTS[_ALWAYS:]:
        if len({one["weights"][key] for one in found if key in one.get("weights", {})}) <= 1:
            left_out.add(key)
    weights = [one for one in _WEIGHTS if one[1] not in left_out]
    figures = [one for one in _FIGURES if one[1] not in left_out]
    rows: list[Row] = [
        [
            one["name"],
            *(_text(factor, one.get("weights", {}).get(key)) for _, key, factor in weights),
            *(_text(1.0, one.get(key)) for _, key in figures),
        ]
        for one in found
    ]
    headings = [one[0] for one in weights] + [one[0] for one in figures]
    return Tabular(title, [*left("Weights"), *right(*headings)], rows, keep=False)


def _text(factor: float, value: float | None) -> str:
    return "" if value is None else number(factor * value, 3)
