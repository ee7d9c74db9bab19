"""Bode plots of both loops over the family, without and with the measurement path."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.figures.style import (
    LIMIT,
    MEASURED,
    NOMINAL,
    WORST,
    band,
    legend_below,
    new_figure,
    style,
)
from mptune.loops.broken import POSITION, VELOCITY
from mptune.params.packed import NO_PATH
from mptune.robust.curves import loop_curves

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from mptune.arrays import ComplexArray, FloatArray
    from mptune.robust.result import SweepResult

_POINTS = 300
_PHASE_FLOOR = -540.0  # degrees; below it the gain is far too small to matter


def bode_plots(result: SweepResult) -> Figure:
    """Draw magnitude and phase of the velocity loop (left) and the position loop (right)."""
    with style():
        figure = new_figure(4.7)
        axes = figure.subplots(2, 2, sharex=True)
        for column, which in enumerate((VELOCITY, POSITION)):
            _draw(axes[0, column], axes[1, column], result, which)
        legend_below(figure, *axes.ravel())
    return figure


def _draw(magnitude: Axes, phase: Axes, result: SweepResult, which: int) -> None:
    model, gains, condition = result.model, result.gains, result.conditions[which]
    low = max(float(result.omega[0]), 0.2 * (gains.k_p_pos if which == POSITION else 5.0))
    omega = np.geomspace(low, min(float(result.omega[-1]), 500.0), _POINTS)
    family = loop_curves(which, omega, model.loops(gains))
    band(magnitude, omega, _decibel(family), "family")
    band(phase, omega, _degrees(family), "family")
    nominal = loop_curves(which, omega, model.nominal_loop(gains))
    lines = [(nominal, "nominal plant", NOMINAL)]
    if condition.at.response is None:
        worst = model.loops(gains, plants=model.plant(condition.at))
        lines.append((loop_curves(which, omega, worst), "worst plant", WORST))
        if model.path == NO_PATH:
            explicit = model.plant(condition.at, as_it_runs=True)
            measured = loop_curves(which, omega, model.as_it_runs(gains, explicit))
            dotted = {**WORST, "linestyle": ":"}
            lines.append((measured, f"worst plant, {MEASURED[model.paths[1]]}", dotted))
    for loop, label, look in lines:
        magnitude.plot(omega, _decibel(loop)[0], label=label, **look)
        phase.plot(omega, _degrees(loop)[0], label=label, **look)
    _finish(magnitude, phase, omega, condition.name)


def _finish(magnitude: Axes, phase: Axes, omega: FloatArray, name: str) -> None:
    magnitude.axhline(0, **{**LIMIT, "linewidth": 0.8})
    phase.axhline(-180, **{**LIMIT, "linewidth": 0.8})
    magnitude.set(xscale="log", ylabel="Magnitude [dB]", ylim=(-40, 40))
    magnitude.set_title(f"{name.capitalize()} loop", loc="left")
    phase.set(xlabel="Frequency [rad/s]", ylabel="Phase [°]", ylim=(_PHASE_FLOOR, -45))
    phase.set_yticks(np.arange(-540, -44, 90))
    phase.set_xlim(omega[0], omega[-1])


def _decibel(loop: ComplexArray) -> FloatArray:
    return np.asarray(20 * np.log10(np.abs(loop)))


def _degrees(loop: ComplexArray) -> FloatArray:
    """Return the phase, unwrapped along frequency and starting within (−360°, 0]."""
    phase = np.unwrap(np.angle(loop), axis=-1)
    phase = phase - 2 * np.pi * np.ceil(phase[:, :1] / (2 * np.pi))
    return np.asarray(np.degrees(phase))
