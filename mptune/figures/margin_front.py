"""What a disk margin costs: index, noise and compliance over it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mptune.figures.style import NOMINAL, WORST, legend_below, new_figure, style

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure


def index_over_margin(rows: Sequence[dict[str, Any]]) -> Figure:
    """Draw the linear index and the machine's, noise and peak compliance over the disk margin.

    Parameters
    ----------
    rows
        As ``mptune.job.margin_front`` has them.
    """
    margin = [one["figures"]["disk_margin"] for one in rows]
    with style():
        figure = new_figure(2.9)
        index, noise, soft = figure.subplots(1, 3)
        linear = [1e3 * one["figures"]["tracking_index_s"] for one in rows]
        machine = [
            float("nan") if one["performance_index_ms"] is None else one["performance_index_ms"]
            for one in rows
        ]
        index.plot(margin, linear, marker="o", markersize=4, label="linear loop", **NOMINAL)
        index.plot(margin, machine, marker="s", markersize=4, label="machine", **WORST)
        heard = [one["noise_force_n"] for one in rows]
        noise.plot(margin, heard, marker="o", markersize=4, **NOMINAL)
        give = [1e6 * one["figures"]["peak_compliance_m_per_n"] for one in rows]
        soft.plot(margin, give, marker="o", markersize=4, **NOMINAL)
        index.set_ylabel("Worst index [ms]")
        noise.set_ylabel("Noise of F_ref, rms [N]")
        soft.set_ylabel("Peak compliance [mm/kN]")
        for axes in (index, noise, soft):
            axes.set(xlabel="Disk margin [–]")
            axes.margins(0.08)
            axes.set_ylim(0, 1.08 * axes.dataLim.y1)  # from 0 on: margins would be lost above
        legend_below(figure, index)
    return figure
