"""One move on the nonlinear machine beside that of the published gains, drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.explore.looks import Titles, hover, line, link, new_plot
from mptune.explore.plotted import source
from mptune.params.chambers import LETTERS

if TYPE_CHECKING:
    from bokeh.plotting import figure

    from mptune.arrays import FloatArray
    from mptune.explore.move import SimulatedMove

_TIME = "Time [s]"
_ROLES = ("nominal", "chosen", "nominal", "chosen")
_DASHES = ("solid", "dotted", "dashed", "dotdash")


class MoveView:
    """Position error, force and valve states of one move."""

    def __init__(self) -> None:
        self.titles = Titles()
        self._error = new_plot("Position error", _TIME, "x_ref − x [mm]")
        self._force = new_plot("Force", _TIME, "F [kN]")
        self._states = new_plot("Valve states of the chambers", _TIME, "Number of the state [–]")
        self._now = source("time", "error", "force", "reference", *LETTERS)
        self._published = source("time", "error", "force")
        drawn = [
            line(
                self._error, self._published, "time", "error", "nominal", legend_label="published"
            ),
            line(self._error, self._now, "time", "error", "chosen", legend_label="these gains"),
        ]
        hover(self._error, drawn, [("t", "@time{0.000} s"), ("error", "@error{0.000} mm")])
        force = [
            line(self._force, self._now, "time", "reference", "limit", legend_label="F_ref"),
            line(
                self._force, self._published, "time", "force", "nominal", legend_label="published"
            ),
            line(self._force, self._now, "time", "force", "chosen", legend_label="these gains"),
        ]
        hover(self._force, force, [("t", "@time{0.000} s"), ("F", "@force{0.00} kN")])
        self._steps: list[Any] = []
        for name, role, dash in zip(LETTERS, _ROLES, _DASHES, strict=True):
            steps = self._states.step(
                "time", name, source=self._now, mode="after", legend_label=name,
                line_dash=dash,
            )  # fmt: skip
            steps.tags = [role]
            self._steps.append(steps)
        self.plots: list[figure] = [self._error, self._force, self._states]
        link(self.plots)

    def show(self, now: SimulatedMove, published: SimulatedMove) -> None:
        """Show a move beside that of the published gains."""
        numbers = dict(zip(LETTERS, now.states, strict=False))
        entries: list[Any] = self._states.legend[0].items
        for name, steps, entry in zip(LETTERS, self._steps, entries, strict=True):
            steps.visible = entry.visible = name in numbers
        nothing = np.full(len(now.time), np.nan)
        self._now.data = {
            "time": now.time,
            "error": _drawn(1e3 * now.error),
            "force": _drawn(1e-3 * now.force),
            "reference": _drawn(1e-3 * now.force_reference),
            **{name: numbers.get(name, nothing) for name in LETTERS},
        }
        self._published.data = {
            "time": published.time,
            "error": 1e3 * published.error,
            "force": 1e-3 * published.force,
        }
        mass = now.case.mass_kg / 1e3
        self.titles.note(self._error, f"Position error, {mass:g} t, seed {now.case.seed}")


def _drawn(values: FloatArray) -> FloatArray:
    return np.nan_to_num(values, posinf=np.nan, neginf=np.nan)
