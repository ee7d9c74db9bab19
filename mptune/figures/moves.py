"""The closed-loop check: reference and position, error and velocity of each machine."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING

from mptune.figures.style import NOMINAL, REFERENCE, SECOND, WORST, legend_below, new_figure, style
from mptune.sim.judge import worst_per_mass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from mptune.sim.sampled import LinearMove


def move_traces(moves: Sequence[LinearMove]) -> Figure:
    """Draw one case per mass, the one with the largest index, over the movement set."""
    with style():
        figure = new_figure(5.0)
        axes = figure.subplots(3, 1, sharex=True)
        looks = cycle((NOMINAL, WORST, SECOND))
        first = moves[0]
        axes[0].plot(first.time, 1e3 * first.reference, label="reference", **REFERENCE)
        for case in worst_per_mass(moves):
            look = next(looks)
            index = f"{case.performance_index_ms:.1f} ms" if case.stable else "unstable"
            label = f"{case.mass_kg / 1e3:g} t: {index}"
            axes[0].plot(case.time, 1e3 * case.position, label=label, **look)
            error = 1e3 * (case.reference - case.position)
            axes[1].plot(case.time, error, **look)
            axes[2].plot(case.time, 1e3 * case.velocity, **look)
        axes[0].set_ylabel("Position [mm]")
        axes[0].set_title("Sampled linear loop with its filters: the movement set", loc="left")
        legend_below(figure, axes[0])
        axes[1].set_ylabel("Position error [mm]")
        axes[2].set(ylabel="Velocity [mm/s]", xlabel="Time [s]", xlim=(0, first.time[-1]))
        limit = 3e3 * abs(first.reference).max()
        for one in axes:
            low, high = one.get_ylim()
            one.set_ylim(max(low, -limit), min(high, limit))
    return figure
