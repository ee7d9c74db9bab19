"""Certified ratios over frequency, and how far the box may grow in each model."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.certify.envelope import envelope
from mptune.figures.style import EDGE, LIMIT, NOMINAL, WORST, legend_below, new_figure, style
from mptune.robust.certificates import EQUATION_OF
from mptune.robust.tables import EQUATIONS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from mptune.arrays import FloatArray
    from mptune.robust.certificates import Certificates
    from mptune.robust.result import Condition, SweepResult

_INTERVALS = 60
_BELOW, _ABOVE = 30.0, 8.0  # how far from the worst frequency the picture reaches
_NAMES = {
    "equation_17": "Eq. 17",
    "equation_21": "Eq. 21",
    "true": "true, no path",
    "with_path": "true, with path",
    "sampled": "as it runs",
}
_LOOKS: tuple[dict[str, Any], ...] = (
    {"color": NOMINAL["color"], "linestyle": "-"},
    {"color": WORST["color"], "linestyle": "--"},
)


def certified_worst_cases(result: SweepResult) -> Figure:
    """Draw the certified ratios of both equations over frequency, and the radii as bars.

    Raises
    ------
    ValueError
        Where nothing of the sweep is certified.
    """
    found = result.certificates
    if found is None:
        raise ValueError("measured responses stand in the place of the box: nothing is certified")
    ends = _intervals(result)
    with style():
        figure = new_figure(2.9)
        axes = figure.subplots(1, 2, width_ratios=(3, 2) if found.radii else (1, 1e-3))
        for condition, look in zip(result.conditions, _LOOKS, strict=True):
            _ratio(axes[0], result, found, condition, ends, look)
        axes[0].axhline(1, **{**LIMIT, "linewidth": 0.8})
        axes[0].set(xscale="log", xlabel="Frequency [rad/s]", ylabel="Left over right side [–]")
        axes[0].set_ylim(0, None)
        axes[0].set_title("Certified worst ratios", loc="left")
        if found.radii:
            _bars(axes[1], found)
        else:
            axes[1].set_visible(False)
        legend_below(figure, axes[0])
    return figure


def _intervals(result: SweepResult) -> FloatArray:
    """Return the ends of the intervals of frequency [rad/s], about both worst cases."""
    low, high = float(result.omega[0]), float(result.omega[-1])
    peaks = [min(max(one.at.frequency_rad_s, low), high) for one in result.conditions]
    return np.geomspace(min(peaks) / _BELOW, max(peaks) * _ABOVE, _INTERVALS + 1)


def _ratio(
    axes: Axes,
    result: SweepResult,
    found: Certificates,
    condition: Condition,
    ends: FloatArray,
    look: dict[str, Any],
) -> None:
    proved = envelope(
        found.problem, condition.name, result.model.path_name, EQUATION_OF[condition.name], ends
    )
    name = EQUATIONS[condition.name]
    axes.stairs(proved.bound, ends, label=f"{name}, certified", baseline=None, **look)
    shown = (result.omega >= ends[0]) & (result.omega <= ends[-1])
    thin = {**EDGE, "color": look["color"], "linewidth": 0.7}
    axes.plot(result.omega[shown], condition.ratio[shown], label=f"{name}, grid", **thin)


def _bars(axes: Axes, found: Certificates) -> None:
    names = list(found.radii)
    for row, name in enumerate(names):
        one = found.radii[name]
        good = one.lower >= 1
        look = {"color": NOMINAL["color"]} if good else {
            "color": "white", "edgecolor": WORST["color"], "hatch": "////",
        }  # fmt: skip
        axes.barh(row, one.lower, height=0.55, **look)
        text = "—" if one.unproved else f"{one.lower:.3g}"
        place = max(one.lower, 1.0), row  # right of the line at 1 too
        axes.annotate(text, place, xytext=(3, 0), textcoords="offset points", va="center")
    axes.axvline(1, **{**LIMIT, "linewidth": 0.8})
    axes.set_yticks(range(len(names)), [_NAMES[name] for name in names])
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.set_xlim(0, 1.25 * max(1.0, *(one.lower for one in found.radii.values())))
    axes.set_xlabel("Growth of the box [–]")
    axes.set_title("The box may grow by", loc="left")
    axes.grid(visible=False, axis="y")
