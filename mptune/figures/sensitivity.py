"""Sensitivity functions of each loop over the family, and the step of the load."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.figures.steps import family_and_nominal
from mptune.figures.style import (
    LIMIT,
    MEASURED,
    NOMINAL,
    REFERENCE,
    WORST,
    band,
    drawable,
    legend_below,
    new_figure,
    style,
)
from mptune.loops.broken import FORCE, POSITION, VELOCITY
from mptune.params.packed import NO_PATH
from mptune.robust.curves import loop_curves
from mptune.sim.running_steps import StepOf

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from mptune.robust.result import SweepResult

_POINTS = 250
_TITLES = {VELOCITY: "Velocity loop", POSITION: "Position loop", FORCE: "Loop at $F_{ref}$"}
_FLOOR, _CEILING = 0.02, 10.0
_LONGEST = 8.0  # over K_P,pos: the load step has faded by then


def sensitivity_functions(result: SweepResult) -> Figure:
    """Draw |S| above |T| for the velocity loop, the position loop and the loop at F_ref."""
    with style():
        figure = new_figure(4.4)
        axes = figure.subplots(2, 3, sharex=True, sharey=True)
        for column, loop in enumerate((VELOCITY, POSITION, FORCE)):
            _draw(axes[0, column], axes[1, column], result, loop)
            axes[0, column].set_title(_TITLES[loop], loc="left")
            axes[1, column].set_xlabel("Frequency [rad/s]")
        axes[0, 0].set_ylabel("|S| [–]")
        axes[1, 0].set_ylabel("|T| [–]")
        legend_below(figure, *axes.ravel())
    return figure


def _draw(above: Axes, below: Axes, result: SweepResult, loop: int) -> None:
    model, gains = result.model, result.gains
    omega = np.geomspace(1.0, min(float(result.omega[-1]), 500.0), _POINTS)
    family = 1 / (1 + loop_curves(loop, omega, model.loops(gains)))
    nominal = loop_curves(loop, omega, model.nominal_loop(gains))
    highest = int(np.argmax(np.abs(family).max(axis=1)))
    worst = family[highest]
    as_it_runs = model.as_it_runs(gains, model.explicit.picked(np.array([highest])))
    measured = 1 / (1 + loop_curves(loop, omega, as_it_runs)[0])
    for axes, less in ((above, 0), (below, 1)):  # T = 1 − S
        band(axes, omega, np.abs(less - family), "family")
        nominal_size = np.abs(less - 1 / (1 + nominal[0]))
        axes.plot(omega, nominal_size, label="nominal plant", **NOMINAL)
        axes.plot(omega, np.abs(less - worst), label="plant with the highest |S|", **WORST)
        if model.path == NO_PATH:
            look = {**WORST, "linestyle": ":"}
            size = np.abs(less - measured)
            axes.plot(omega, size, label=f"the same, {MEASURED[model.paths[1]]}", **look)
        axes.axhline(1, **{**LIMIT, "linewidth": 0.8})
        axes.set(xscale="log", yscale="log", ylim=(_FLOOR, _CEILING), xlim=(1.0, omega[-1]))
        axes.set_yticks([0.1, 1, 2, 5, 10], ["0.1", "1", "2", "5", "10"])
        axes.set_yticks([], minor=True)


def load_response(result: SweepResult) -> Figure:
    """Draw the position after a load step over the family, per kilonewton."""
    model, gains = result.model, result.gains
    packed = model.loops(gains).gains
    slowest = max(packed.k_p_pos, packed.k_i_pos**0.5, packed.k_p_vel / model.nominal.mass / 100)
    time, *curves = family_and_nominal(model, gains, StepOf.LOAD, _LONGEST / slowest, 301)
    family, nominal = (drawable(1e6 * one) for one in curves)  # mm/kN
    worst = int(np.argmax(np.abs(family).max(axis=1)))
    with style():
        figure = new_figure(2.5)
        axes = figure.subplots()
        band(axes, time, family, "family")
        axes.plot(time, family[worst], label="worst plant", **WORST)
        axes.plot(time, nominal[0], label="nominal plant", **NOMINAL)
        axes.axhline(0, **REFERENCE)
        low, high = float(family.min()), float(family.max())
        axes.set(xlabel="Time [s]", ylabel="Position [mm/kN]", xlim=(0, time[-1]))
        axes.set_ylim(max(1.08 * low, -1.0), max(1.08 * min(high, 1.0), 0.02))
        axes.set_title(f"Load step: up to {np.abs(family).max():.3g} mm/kN", loc="left")
        legend_below(figure, axes)
    return figure
