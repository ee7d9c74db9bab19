"""The chain of gain factors at F_ref: how far the gain may rise, as each model sees it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.figures.style import LIMIT, NOMINAL, WORST, new_figure, style
from mptune.robust.chain import factor_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from mptune.robust.chain import Link

_ROOM = 0.15  # of the bars' span, left at either end for the value written there
_SPAN = (0.8, 2.5)  # the bars' span is taken to be at least this
_TICKS = (0.02, 0.05, 0.1, 0.2, 0.5, 1, 1.5, 2, 3, 5, 10, 20, 50)
_MARGIN: dict[str, Any] = {"color": NOMINAL["color"]}
_BESIDE: dict[str, Any] = {"color": "white", "edgecolor": NOMINAL["color"], "linestyle": ":"}
_LACK: dict[str, Any] = {"color": "white", "edgecolor": WORST["color"], "hatch": "////"}


def gain_chain(links: tuple[Link, ...]) -> Figure:
    """Draw one bar per link from 1 to its factor: to the right where there is room left.

    A factor without limit reaches the axis' end; one that cannot be told has no bar.
    """
    with style():
        figure = new_figure(0.7 + 0.32 * len(links))
        axes = figure.subplots()
        low, high = _ends(links)
        for row, link in enumerate(links):
            _bar(axes, row, link, high)
        axes.axvline(1.0, **LIMIT)
        axes.set(xscale="log", xlim=(low, high), xlabel="Factor on the gain at $F_{ref}$ [–]")
        ticks = [tick for tick in _TICKS if low < tick < high]
        axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        axes.set_xticks([], minor=True)
        axes.set_yticks(range(len(links)), [link.name for link in links])
        axes.set_ylim(len(links) - 0.5, -0.5)  # the first link on top
        axes.grid(visible=False, axis="y")
        axes.set_axisbelow(True)
        axes.tick_params(axis="y", length=0)
    return figure


def _ends(links: tuple[Link, ...]) -> tuple[float, float]:
    """Return the ends of the axis, wide enough for every bar and its value."""
    finite = [link.factor for link in links if np.isfinite(link.factor)]
    low, high = min([*finite, _SPAN[0]]), max([*finite, _SPAN[1]])
    room = (high / low) ** _ROOM
    return low / room, high * room


def _bar(axes: Axes, row: int, link: Link, end: float) -> None:
    factor = link.factor
    reach = min(factor, end) if not np.isnan(factor) else 1.0
    look = _BESIDE if link.beside else _MARGIN if reach >= 1 else _LACK
    axes.barh(row, reach - 1.0, left=1.0, height=0.55, **look)
    inside = np.isinf(factor)  # its bar fills the axis
    axes.annotate(
        factor_text(factor),
        (reach, row),
        xytext=(-4 if inside or reach < 1 else 4, 0),
        textcoords="offset points",
        ha="right" if inside or reach < 1 else "left",
        va="center",
        color="white" if inside else "black",
    )
