"""Nyquist plots of the velocity loop and of the loop at F_ref, about the critical point."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.figures.style import (
    EDGE,
    LIMIT,
    MEASURED,
    NOMINAL,
    WORST,
    legend_below,
    new_figure,
    style,
)
from mptune.loops.broken import FORCE, VELOCITY
from mptune.params.packed import NO_PATH
from mptune.robust.curves import loop_curves
from mptune.robust.encirclements import encirclements

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from mptune.params.packed import Plants
    from mptune.robust.encirclements import Encirclements
    from mptune.robust.result import SweepResult

_POINTS = 1200
_LOWEST, _HIGHEST = 0.5, 2000.0  # rad/s; below, the curves lie far outside the window
_WINDOW = (-3.2, 1.2, -3.0, 1.4)
_TITLES = {VELOCITY: "Velocity loop", FORCE: "Loop at $F_{ref}$"}


def nyquist_plots(result: SweepResult, counts: tuple[Encirclements, ...] = ()) -> Figure:
    """Draw both loops: nominal, worst, and the corners of the family; counts in the titles.

    The encirclements are counted where they are not given.
    """
    counts = counts or encirclements(result)
    with style():
        figure = new_figure(4.0)
        axes = figure.subplots(1, 2)
        for one, loop in zip(axes, (VELOCITY, FORCE), strict=True):
            _draw(one, result, loop)
            one.set_title(_title(loop, counts), loc="left", fontsize=8.5)
        legend_below(figure, *axes)
    return figure


def _title(loop: int, counts: tuple[Encirclements, ...]) -> str:
    most = {one.path: one.most for one in counts if one.loop == loop}
    words = {"none": "{}", "filters": "with path {}", "estimator": "estimated {}"}
    said = ", ".join(words[path].format(number) for path, number in most.items())
    return f"{_TITLES[loop]}: encirclements {said}"


def _draw(axes: Axes, result: SweepResult, loop: int) -> None:
    model, gains = result.model, result.gains
    omega = np.geomspace(_LOWEST, _HIGHEST, _POINTS)
    corners = loop_curves(loop, omega, model.loops(gains, plants=_corners(model.plants)))
    for n, curve in enumerate(corners):
        label = "corners of the family" if n == 0 else None
        axes.plot(curve.real, curve.imag, label=label, **{**EDGE, "linewidth": 0.5, "alpha": 0.7})
    nominal = loop_curves(loop, omega, model.nominal_loop(gains))[0]
    axes.plot(nominal.real, nominal.imag, label="nominal plant", **NOMINAL)
    at = (result.velocity if loop == VELOCITY else result.position).at
    if at.response is None:
        looks = [(model.path, "worst plant", WORST)]
        if model.path == NO_PATH:
            words = f"worst plant, {MEASURED[model.paths[1]]}"
            looks.append((model.filters, words, {**WORST, "linestyle": ":"}))
        for path, label, look in looks:
            plant = model.plant(at, as_it_runs=path != NO_PATH)
            curve = loop_curves(loop, omega, model.loops(gains, path, plant))[0]
            axes.plot(curve.real, curve.imag, label=label, **look)
    turn = np.linspace(0, 2 * np.pi, 200)
    circle = {**LIMIT, "linewidth": 0.8}
    axes.plot(-1 + 0.5 * np.cos(turn), 0.5 * np.sin(turn), label="$|S|$ = 2", **circle)
    axes.plot(-1, 0, marker="+", color="black", markersize=8, linestyle="none", label="−1")
    left, right, low, high = _WINDOW
    axes.set(xlim=(left, right), ylim=(low, high), aspect="equal")
    axes.set(xlabel="Real part [–]", ylabel="Imaginary part [–]")


def _corners(plants: Plants) -> Plants:
    """Return the plants all of whose parameters are at an end of their range."""
    ends = np.ones(len(plants.mass), np.bool_)
    for column in plants:
        ends &= (column == column.min()) | (column == column.max())
    return plants.picked(ends)
