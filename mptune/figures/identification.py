"""Fig. 3: simulated frequency responses of the force loop beside Eq. 11 with its delay."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.escaping import figure_text
from mptune.figures.style import EDGE, LIMIT, NOMINAL, legend_below, new_figure, style
from mptune.identify.result import over_points

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from mptune.identify.result import Panel

_COLUMNS = 2
_ROW_HEIGHT = 3.3  # inches, of magnitude and phase together
_POINT = {**EDGE, "linewidth": 0.5, "alpha": 0.35, "marker": ".", "markersize": 2.5}


def bode_panels(panels: tuple[Panel, ...]) -> Figure:
    """Draw magnitude and phase of each panel: points light, their median solid, theory dashed.

    Fits that are not valid are left out and counted below the curves.
    """
    with style():
        rows = -(-len(panels) // _COLUMNS)
        figure = new_figure(_ROW_HEIGHT * rows + 0.4)
        axes = figure.subplots(
            2 * rows, _COLUMNS, sharex=True, squeeze=False, height_ratios=[1.15, 1] * rows
        )
        for k, panel in enumerate(panels):
            row, column = 2 * (k // _COLUMNS), k % _COLUMNS
            _draw(axes[row, column], axes[row + 1, column], panel)
        for spare in range(len(panels), rows * _COLUMNS):
            for one in axes[2 * (spare // _COLUMNS) :, spare % _COLUMNS]:
                one.remove()
        figure.align_ylabels()
        legend_below(figure, axes[0, 0])
    return figure


def _draw(magnitude: Axes, phase: Axes, panel: Panel) -> None:
    """Draw one panel; phases are theory's, unwrapped, plus the deviation from it."""
    omega = panel.omega
    theory = 20 * np.log10(np.abs(panel.theory))
    angle = np.degrees(np.unwrap(np.angle(panel.theory)))
    for axes, base, deviation in (
        (magnitude, theory, panel.decibels),
        (phase, angle, panel.degrees),
    ):
        drawn = np.unique(np.round(deviation, 3), axis=0)  # many points end in the same response
        lines = axes.plot(omega, base[:, None] + drawn.T, **_POINT)
        lines[0].set_label("simulated, each operating point")
        axes.plot(omega, base + over_points(deviation, 50), label="their median", **NOMINAL)
        axes.plot(omega, base, label="$G_F$ with its delay", **LIMIT)
    magnitude.set(xscale="log", ylabel="Magnitude [dB]", ylim=(-15, 7))
    phase.set(xlabel="Frequency [rad/s]", ylabel="Phase [°]", xlim=(omega[0], omega[-1]))
    phase.set_yticks(np.arange(-360, 1, 45))
    phase.set_ylim(min(-180.0, float(np.floor(angle.min() / 45) * 45 - 15)), 15)
    magnitude.set_title(figure_text(panel.name), loc="left", fontsize=8)
    magnitude.text(0.02, 0.06, _counts(panel), transform=magnitude.transAxes, fontsize=7)


def _counts(panel: Panel) -> str:
    text = f"{len(panel.velocity)} points"
    if panel.skipped:
        text += f", {panel.skipped} skipped"
    return f"{text}; {panel.failed} of {panel.status.size} fits not valid"
