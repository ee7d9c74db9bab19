"""Fig. 5's four panels: both sides of Eq. 17 and Eq. 21, and both loops' step responses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.figures.steps import family_and_nominal
from mptune.figures.style import (
    BAND,
    EDGE,
    LIMIT,
    NOMINAL,
    REFERENCE,
    WORST,
    band,
    drawable,
    legend_below,
    new_figure,
    style,
)
from mptune.robust.curves import error_curves
from mptune.robust.tables import EQUATIONS
from mptune.sim.running_steps import StepOf

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from mptune.arrays import FloatArray
    from mptune.params.packed import LoopGains, Plants
    from mptune.robust.result import Condition, SweepResult

_POINTS = 300


def four_panels(result: SweepResult) -> Figure:
    """Draw Fig. 5 for one sweep: inequalities on the left, step responses on the right.

    Measured members stand in the inequalities; the steps are those of the box's plants.
    """
    with style():
        figure = new_figure(5.1)
        axes = figure.subplots(2, 2)
        left = _left_curves(result)
        for row, condition in enumerate(result.conditions):
            _draw_sides(axes[row, 0], condition, result.omega, *left, row)
            _draw_steps(axes[row, 1], result, condition)
        legend_below(figure, *axes.ravel())
    return figure


def _left_curves(result: SweepResult) -> tuple[FloatArray, FloatArray]:
    """Return frequencies and |Δ| of the whole family, ``(2, N, F)``; 0 where a plant has none."""
    model = result.model
    omega = np.geomspace(result.omega[0], result.omega[-1], _POINTS)
    loop = model.nominal_gains(omega, result.gains)[0]
    curves = error_curves(omega, model.plants, model.nominal, loop)
    members = model.members
    if members is None:
        return omega, curves
    curves[:, :, members.replaces(omega)] = 0.0
    return omega, np.concatenate([curves, members.errors(omega, model.nominal, loop)], axis=1)


def _draw_sides(
    axes: Axes,
    condition: Condition,
    grid: FloatArray,
    omega: FloatArray,
    curves: FloatArray,
    row: int,
) -> None:
    axes.fill_between(omega, 1e-4, curves[row].max(axis=0), label="family", **BAND)
    axes.plot(grid, condition.left, **EDGE)
    worst = int(condition.plant[np.argmax(condition.ratio)])
    curve = np.where(curves[row, worst] > 0, curves[row, worst], np.nan)
    axes.plot(omega, curve, label="worst plant", **WORST)
    axes.plot(grid, condition.right, label="right-hand side", **LIMIT)
    axes.set(xscale="log", yscale="log", xlabel="Frequency [rad/s]", ylabel="Magnitude [–]")
    peak = condition.at.frequency_rad_s
    if condition.low_frequency_limit:
        place, first = "as ω → 0", float(grid[-1]) / 1e5
    else:
        place, first = f"at {peak:.3g} rad/s", peak / 300
        axes.axvline(peak, color=WORST["color"], linewidth=0.6)
    title = f"{EQUATIONS[condition.name]}: worst ratio {condition.worst_ratio:.3f} {place}"
    axes.set_title(title, loc="left")
    top = 3 * max(float(curves[row].max()), 1.0)
    axes.set_ylim(max(float(condition.left[0]) / 5, 0.02), max(top, 20))
    axes.set_xlim(max(grid[0], first), grid[-1])


def _draw_steps(axes: Axes, result: SweepResult, condition: Condition) -> None:
    model = result.model
    of = StepOf.VELOCITY if condition.name == "velocity" else StepOf.POSITION
    horizon = step_horizon(model.loops(result.gains).gains, model.plants)[of]
    time, *found = family_and_nominal(model, result.gains, of, horizon, 401)
    curves, nominal = map(drawable, found)
    worst = int(np.argmax(np.abs(curves).max(axis=1)))
    band(axes, time, curves, "family")
    axes.plot(time, curves[worst], label="worst plant", **WORST)
    axes.plot(time, nominal[0], label="nominal plant", **NOMINAL)
    axes.axhline(1, label="reference", **REFERENCE)
    top = min(float(curves.max()), 3.0)
    axes.set(
        xlabel="Time [s]",
        ylabel=f"{condition.name.capitalize()} over its reference [–]",
        xlim=(0, time[-1]),
        ylim=(min(-0.05, 1.05 * max(float(curves.min()), -1.0)), 1.08 * max(top, 1.0)),
    )
    overshoot = 100 * (float(curves.max()) - 1)
    axes.set_title(
        f"{condition.name.capitalize()} step: overshoot up to {overshoot:.0f} %", loc="left"
    )


def step_horizon(gains: LoopGains, plants: Plants) -> tuple[float, float]:
    """Return how long to draw the velocity and the position step [s].

    Until what is slow has faded: the velocity loop, and the position loop where it is closed. An
    open one, without gains, moves nothing.
    """
    velocity = 8 * float(plants.mass.max()) / gains.k_p_vel + 10 * float(plants.delay.max())
    rate = max(gains.k_p_pos, gains.k_i_pos**0.5)
    position = velocity + (7 / rate if rate > 0 else 0.0)
    return _rounded(velocity), _rounded(position)


def _rounded(value: float) -> float:
    scale = 10.0 ** np.floor(np.log10(value))
    return float(np.ceil(value / scale * 5) / 5 * scale)
