"""The search over the weights: what is won in one figure is lost in another."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.figures.style import legend_below, new_figure, style
from mptune.sim.merit import merit
from mptune.weigh.trial import OBJECTIVES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from matplotlib.figure import Figure

    from mptune.weigh.result import WeightsResult
    from mptune.weigh.trial import Trial

_LABELS = {
    **{key: merit(key).axis for key in OBJECTIVES},
    "weight_switching": "W_sw [N]",
    "weight_loss": "W_loss [N/J]",
    "weight_converter": "W_conv [N s/m⁶]",
    "weight_compression": "W_comp [N/J]",
}
_PLANES = (
    ("performance_index_ms", "energy_loss_j_per_mm"),
    ("force_error_integral_kn2s", "energy_loss_j_per_mm"),
    ("valve_switches", "energy_loss_j_per_mm"),
    ("valve_switches", "force_error_integral_kn2s"),
    ("weight_loss", "weight_switching"),
)
_DOT: dict[str, Any] = {"linestyle": "", "markeredgewidth": 0.7}
_UNUSABLE: dict[str, Any] = {**_DOT, "marker": "x", "color": "0.6", "markersize": 4}
_BEATEN: dict[str, Any] = {**_DOT, "marker": "o", "color": "0.75", "markersize": 3.5}
_FRONT: dict[str, Any] = {**_DOT, "marker": "o", "color": "#0072b2", "markersize": 4.5}
_ORDER: dict[str, Any] = {**_DOT, "marker": "^", "color": "#009e73", "markersize": 8}
_OWN: dict[str, Any] = {**_DOT, "marker": "D", "color": "black", "markersize": 6}
_TAKEN: dict[str, Any] = {
    **_DOT, "marker": "*", "color": "#d55e00", "markersize": 12, "markeredgecolor": "black",
}  # fmt: skip
_BEYOND = 1.5  # of the front's range: how far an axis goes


def weights_figure(result: WeightsResult) -> Figure:
    """Draw every trial in four planes of figures and one or two of weights.

    The study's own and the recommended weights stand where other random numbers put them.
    """
    keeps = result.limits.keeps
    layers: tuple[tuple[str, dict[str, Any], list[Trial]], ...] = (
        ("limit broken", _UNUSABLE, [trial for trial in result.trials if not keeps(trial)]),
        ("beaten", _BEATEN, [trial for trial in result.trials if keeps(trial)]),
        ("front", _FRONT, [result.trials[place] for place in result.front]),
        ("paper's order", _ORDER, _last_of_the_order(result)),
        ("own", _OWN, [result.recommendation.own]),
        ("recommended", _TAKEN, [result.recommendation.trial]),
    )
    with style():
        figure = new_figure(5.4)
        axes = figure.subplots(2, 3)
        planes = [*_PLANES, *_third_weight(result)]
        for empty in axes.ravel()[len(planes) :]:
            empty.set_axis_off()
        for one, (across, up) in zip(axes.ravel(), planes, strict=False):
            for label, look, trials in layers:
                x, y = ([_value(trial, name) for trial in trials] for name in (across, up))
                one.plot(x, y, label=label, **look)
            one.set(xlabel=_LABELS[across], ylabel=_LABELS[up])
            for name, set_limits, scale in (
                (across, one.set_xlim, one.set_xscale),
                (up, one.set_ylim, one.set_yscale),
            ):
                if name.startswith("weight"):
                    scale("log")
                else:
                    shown = [trial for _, _, trials in layers[2:] for trial in trials]
                    _around([_value(trial, name) for trial in shown], set_limits)
        legend_below(figure, axes[0, 0])
    return figure


def _third_weight(result: WeightsResult) -> Iterator[tuple[str, str]]:
    """Yield the plane of W_conv, or of what a decision without converters weighs in its place."""
    study = result.study.study
    if study.converters:
        yield "weight_loss", "weight_converter"
    elif study.controller.force_model == "steady-state":
        yield "weight_switching", "weight_compression"


def _last_of_the_order(result: WeightsResult) -> list[Trial]:
    return [step.trial for step in result.steps if step.trial.weights == result.by_order][-1:]


def _value(trial: Trial, name: str) -> float:
    if name.startswith("weight"):
        return float(getattr(trial.weights, name))
    return trial.mean(name)


def _around(values: list[float], set_limits: Callable[[float, float], object]) -> None:
    """Leave out what is so bad that it would squeeze the rest."""
    low, high = min(values), float(np.quantile(values, 0.95))
    room = 0.08 * (high - low) + 1e-6 * abs(high)
    set_limits(low - room, low + _BEYOND * (high - low) + room)
