"""Loss over index of several studies, beside what the paper measured."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.escaping import figure_text
from mptune.figures.style import legend_below, new_figure, style
from mptune.params.paper import MEASURED_INDEX_RANGE, MEASURED_LOSS
from mptune.sim.merit import merit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LOOKS = (
    ("#0072b2", "o"), ("#d55e00", "s"), ("#009e73", "D"), ("#cc79a7", "^"), ("#56b4e9", "v"),
    ("#e69f00", "P"),
)  # fmt: skip
_INDEX, _LOSS = merit("performance_index_ms"), merit("energy_loss_j_per_mm")


def studies_apart(rows: Sequence[dict[str, Any]]) -> Figure:
    """Draw every study on every mass: open under its own gains, filled under the tuned ones.

    Parameters
    ----------
    rows
        As ``mptune.job.studies.rows_of`` has them; those without figures of the machine are left
        out.
    """
    drawn = [one for one in rows if one[_INDEX.key] is not None and one[_LOSS.key] is not None]
    masses = sorted({one["mass_kg"] for one in drawn} | set(MEASURED_LOSS))
    names = list(dict.fromkeys(one["study"] for one in drawn))
    with style():
        figure = new_figure(3.2)
        panels = np.atleast_1d(figure.subplots(1, len(masses), sharex=True, sharey=True))
        for axes, mass in zip(panels, masses, strict=True):
            _measured(axes, mass)
            for number, name in enumerate(names):
                mine = [one for one in drawn if one["study"] == name and one["mass_kg"] == mass]
                _study(axes, mine, name, number)
            axes.set(title=f"{mass / 1e3:g} t", xlabel=f"{_INDEX.axis}\npredicted")
            axes.margins(0.08)
        panels[0].set_xlim(0, panels[0].get_xlim()[1])  # shared, and so of what all panels hold
        panels[0].set_ylim(0, panels[0].get_ylim()[1])
        panels[0].set_ylabel(f"{_LOSS.axis}\ncalibrated")
        legend_below(figure, *panels, columns=3)
    return figure


def _measured(axes: Axes, mass: float) -> None:
    """Draw the range of the index and the mean loss that §7 measured on a mass [kg]."""
    if mass in MEASURED_LOSS:
        loss, ends = MEASURED_LOSS[mass], [1e3 * end for end in MEASURED_INDEX_RANGE[mass]]
        look: dict[str, Any] = {"color": "black", "marker": "|", "linewidth": 1.4}
        axes.plot(ends, [loss, loss], label="the paper, measured", **look)


def _study(axes: Axes, rows: Sequence[dict[str, Any]], name: str, number: int) -> None:
    """Draw one study on one mass."""
    color, marker = _LOOKS[number % len(_LOOKS)]
    index, loss = [one[_INDEX.key] for one in rows], [one[_LOSS.key] for one in rows]
    axes.plot(index, loss, color=color, linewidth=0.8)
    for one, x, y in zip(rows, index, loss, strict=True):
        face = color if one["gains"] == "tuned" else "white"
        label = figure_text(name) if one is rows[-1] else None
        look: dict[str, Any] = {
            "color": color, "marker": marker, "markersize": 6, "linestyle": "none",
        }  # fmt: skip
        axes.plot(x, y, markerfacecolor=face, label=label, **look)
