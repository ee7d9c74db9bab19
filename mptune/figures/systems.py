"""Loss over index of every system: what a drive costs against how well it follows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.figures.style import legend_below, new_figure, style
from mptune.params.paper import MEASURED_LOSS, OTHER_SYSTEMS
from mptune.sim.merit import merit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_COLORS = (
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#999999", "black",
)  # fmt: skip
_MARKERS = "osD^vP*X"
_ROOM = 1.3  # times the largest index, where the next tick may stand
_MOST_TICKS = 9
_INDEX, _LOSS = merit("performance_index_ms"), merit("energy_loss_j_per_mm")


def loss_over_index(rows: Sequence[dict[str, Any]]) -> Figure:
    """Draw every run: filled by its literature's gains, open by the best ones under one rule.

    The machine of a study beside this one is filled by that study's own gains.

    Parameters
    ----------
    rows
        As ``SystemsResult.rows`` has them; all but runs are left out.
    """
    runs = [one for one in rows if one["kind"] == "run" and one["stable"]]
    masses = sorted({one["mass_kg"] for one in runs})
    systems = list(dict.fromkeys((one["system"], one["title"]) for one in runs))
    with style():
        figure = new_figure(3.8)
        panels = np.atleast_1d(figure.subplots(1, len(masses) or 1, sharex=True, sharey=True))
        for axes, mass in zip(panels, masses, strict=False):
            for number, (key, title) in enumerate(systems):
                mine = [one for one in runs if one["system"] == key and one["mass_kg"] == mass]
                _system(axes, mine, title, number)
            axes.set(title=f"{mass / 1e3:g} t", xlabel=_INDEX.axis, xscale="log")
            axes.margins(x=0.15)
        beside = MEASURED_LOSS.keys() & set(masses)  # another machine's losses are others
        for one in OTHER_SYSTEMS if beside else ():
            for axes in panels:
                if one.key in dict(systems):
                    axes.axhline(one.loss, color="#bbbbbb", linewidth=0.7, linestyle=":", zorder=0)
        ticks = _ticks_among([one[_INDEX.key] for one in runs])
        for axes in panels:
            axes.set_xticks(ticks, [str(tick) for tick in ticks])
            axes.minorticks_off()
        panels[0].set_ylabel(_LOSS.axis)
        panels[0].set_ylim(0, panels[0].get_ylim()[1])  # shared, and so of what all panels hold
        legend_below(figure, *panels, columns=3)
    return figure


def _ticks_among(values: Sequence[float]) -> list[int]:
    """Return round numbers from just below the least of some values to just above the largest.

    Of a wide range there are fewer in each decade, so that their texts stay apart.
    """
    room = (min(values, default=10) / _ROOM, max(values, default=100) * _ROOM)
    ticks: list[int] = []
    for factors in ((1, 2, 3, 5), (1, 3), (1,)):
        steps = (factor * 10**decade for decade in range(7) for factor in factors)
        ticks = [tick for tick in steps if room[0] <= tick <= room[1]]
        if len(ticks) <= _MOST_TICKS:
            break
    return ticks


def _system(axes: Axes, runs: Sequence[dict[str, Any]], title: str, number: int) -> None:
    """Draw one system: from its literature's controller to its best one, as far as they stand."""
    look: dict[str, Any] = {
        "color": _COLORS[number % len(_COLORS)],
        "marker": _MARKERS[number % len(_MARKERS)],
    }
    index = [one[_INDEX.key] for one in runs]
    loss = [one[_LOSS.key] for one in runs]
    axes.plot(index, loss, color=look["color"], linewidth=0.8)
    for one, x, y in zip(runs, index, loss, strict=True):
        face = look["color"] if one["controller"] in {"literature", "its own"} else "white"
        label = title if one is runs[0] else None
        axes.plot(x, y, markerfacecolor=face, linestyle="none", markersize=6, label=label, **look)
