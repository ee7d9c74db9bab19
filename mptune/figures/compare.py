"""Gains over one another: both inequalities, and the error of the heaviest machine in time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mptune.escaping import figure_text
from mptune.figures.style import (
    LIMIT,
    NOMINAL,
    REFERENCE,
    SECOND,
    WORST,
    legend_below,
    new_figure,
    style,
)
from mptune.robust.tables import EQUATIONS
from mptune.sim.judge import worst_per_mass

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from matplotlib.figure import Figure

    from mptune.robust.result import SweepResult
    from mptune.sim.sampled import LinearMove

    Drawn = tuple[str, SweepResult, tuple[LinearMove, ...]]

_LOOKS: tuple[dict[str, Any], ...] = (
    NOMINAL,
    WORST,
    SECOND,
    {"color": "#cc79a7", "linewidth": 1.4, "linestyle": (0, (5, 1, 1, 1, 1, 1))},
    {"color": "#56b4e9", "linewidth": 1.4, "linestyle": (0, (1, 1))},
    {"color": "#e69f00", "linewidth": 1.4, "linestyle": (0, (8, 2))},
)


def look_of(number: int) -> dict[str, Any]:
    """Return the look of one of several things drawn over one another."""
    return _LOOKS[number % len(_LOOKS)]


def compared_gains(entries: Sequence[Drawn]) -> Figure:
    """Draw left over right of both inequalities, and position error and velocity in time.

    Each entry is a label, a sweep, and linear moves, of which the heaviest mass's worst is drawn.
    """
    with style():
        figure = new_figure(5.2)
        axes = figure.subplots(2, 2)
        for n, (name, swept, moves) in enumerate(entries):
            label = figure_text(name)
            look = look_of(n)
            _ratios(axes[:, 0], label, swept, look)
            case = max(worst_per_mass(moves), key=lambda one: one.mass_kg)
            if case.stable:
                error = 1e3 * (case.reference - case.position)
                axes[0, 1].plot(case.time, error, label=label, **look)
                axes[1, 1].plot(case.time, 1e3 * case.velocity, label=label, **look)
        _finish(axes, entries)
        legend_below(figure, *axes.ravel())
    return figure


def _ratios(
    axes: np.ndarray[tuple[int], np.dtype[np.object_]],
    label: str,
    swept: SweepResult,
    look: dict[str, Any],
) -> None:
    for one, condition in zip(axes, swept.conditions, strict=True):
        one.semilogx(swept.omega, condition.ratio, label=label, **look)


def _finish(
    axes: np.ndarray[tuple[int, int], np.dtype[np.object_]], entries: Sequence[Drawn]
) -> None:
    highest = max(float(swept.omega[-1]) for _, swept, _ in entries)
    for one, name in zip(axes[:, 0], EQUATIONS, strict=True):
        conditions = [getattr(swept, name) for _, swept, _ in entries]
        top = max(condition.worst_ratio for condition in conditions)
        one.axhline(1, label="limit of the theorem", **{**LIMIT, "linewidth": 0.8})
        one.set(xlabel="Frequency [rad/s]", ylabel="Left over right side [–]")
        one.set(xlim=(0.5, highest), ylim=(0, 1.08 * max(1.0, min(top, 3.0))))
        one.set_title(f"{EQUATIONS[name]} ({name})", loc="left")
    error, velocity = axes[:, 1]
    error.set(xlabel="Time [s]", ylabel="Position error [mm]")
    velocity.set(xlabel="Time [s]", ylabel="Velocity [mm/s]")
    error.set_title("Sampled linear loop, heaviest mass", loc="left")
    for one in (error, velocity):
        one.axhline(0, **REFERENCE)
        longest = max(float(moves[0].time[-1]) for _, _, moves in entries)
        one.set_xlim(0, longest)
