"""What tuning trades: controllers side by side, and the front of tracking against disturbance."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.figures.style import LIMIT, NOMINAL, SECOND, WORST, legend_below, new_figure, style
from mptune.tune.baselines import LABELS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from mptune.tune.baselines import Baseline
    from mptune.tune.front import Front

_LOOKS = {
    "own": {**LIMIT, "linestyle": ":"},
    "p": {"color": "#999999", "linewidth": 1.2, "linestyle": "-"},
    "pi": SECOND,
    "pid": WORST,
    "eq22": NOMINAL,
}


def compared_controllers(rows: tuple[Baseline, ...]) -> Figure:
    """Draw Eq. 21's right side of each controller above the family's error, and their indices."""
    with style():
        figure = new_figure(3.1)
        sides, bars = figure.subplots(1, 2, width_ratios=(3, 2))
        for one in rows:
            condition, omega = one.sweep.position, one.sweep.omega
            sides.loglog(omega, condition.right, label=LABELS[one.name], **_LOOKS[one.name])
        best = rows[-1].sweep
        sides.loglog(best.omega, best.position.left, label="max|Δ| of the family", **LIMIT)
        low = np.nanmin(best.position.left[best.omega > 1.0])
        sides.set(
            xlabel="Frequency [rad/s]",
            ylabel="Both sides of Eq. 21 [–]",
            xlim=(1.0, float(best.omega[-1])),
            ylim=(max(0.3 * low, 1e-3), 1e3),
            title="Eq. 21",
        )
        places = np.arange(len(rows))
        index = [1e3 * one.figures.tracking for one in rows]
        drawn = [value if np.isfinite(value) else 0.0 for value in index]  # a loop that runs away
        colors = [_LOOKS[one.name]["color"] for one in rows]
        bars.barh(places, drawn, height=0.55, color=colors)
        for place, value, end in zip(places, index, drawn, strict=True):
            text = f"{value:.1f}" if np.isfinite(value) else "–"
            bars.annotate(text, (end, place), (3, 0), textcoords="offset points", va="center")
        bars.set_yticks(places, [LABELS[one.name] for one in rows])
        bars.set(xlabel="Worst performance index [ms]", xlim=(0, 1.25 * max(drawn)), title="Index")
        bars.set_ylim(len(rows) - 0.5, -0.5)
        bars.grid(visible=False, axis="y")
        bars.set_axisbelow(True)
        legend_below(figure, sides)
    return figure


def pareto_front(front: Front) -> Figure:
    """Draw the least index for each integral gain, and where the study's own gains lie."""
    with style():
        figure = new_figure(2.9)
        axes = figure.subplots()
        gain = [point.figures.integral_gain for point in front.points]
        index = [1e3 * point.figures.tracking for point in front.points]
        axes.plot(gain, index, marker="o", markersize=4, label="tuned", **NOMINAL)
        axes.plot(
            front.own.integral_gain,
            1e3 * front.own.tracking,
            marker="s",
            linestyle="none",
            color="black",
            label="the study's own gains",
        )
        axes.set(xlabel="K_I,pos [1/s²]", ylabel="Worst performance index [ms]")
        axes.margins(0.08)
        legend_below(figure, axes)
    return figure
