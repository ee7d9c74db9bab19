"""One move on the nonlinear machine beside that of the published gains, drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.explore.looks import Titles, hover, line, link, new_plot
from mptune.explore.plotted import source

if TYPE_CHECKING:
    from bokeh.plotting import figure

    from mptune.arrays import FloatArray
    from mptune.explore.move import SimulatedMove

_TIME = "Time [s]"


class MoveView:
    """Position error, force and valve states of one move."""

    def __init__(self) -> None:
        self.titles = Titles()
        self._error = new_plot("Position error", _TIME, "x_ref − x [mm]")
        self._force = new_plot("Force", _TIME, "F [kN]")
        self._states = new_plot("Valve states of A and B", _TIME, "Number of the state [–]")
        self._now = source("time", "error", "force", "reference", "a", "b")
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
        for name, role in (("a", "nominal"), ("b", "chosen")):
            steps = self._states.step(
                "time", name, source=self._now, mode="after", legend_label=f"state {name.upper()}",
                line_dash="solid" if name == "a" else "dotted",
            )  # fmt: skip
            steps.tags = [role]
        self.plots: list[figure] = [self._error, self._force, self._states]
        link(self.plots)

    def show(self, now: SimulatedMove, published: SimulatedMove) -> None:
        """Show a move beside that of the published gains."""
        self._now.data = {
            "time": now.time,
            "error": _drawn(1e3 * now.error),
            "force": _drawn(1e-3 * now.force),
            "reference": _drawn(1e-3 * now.force_reference),
            "a": now.state_a,
            "b": now.state_b,
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
