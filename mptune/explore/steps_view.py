"""The steps of velocity, position and load, drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.explore.looks import Titles, new_plot, reach
from mptune.explore.plotted import CurveSet

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.explore.picture import Picture


class StepsView:
    """Steps of velocity and position, and of the load."""

    def __init__(self) -> None:
        self.titles = Titles()
        titles = ("Velocity step", "Position step", "Load step")
        labels = ("Velocity over its reference [–]", "Position over its reference [–]",
                  "Position [mm/kN]")  # fmt: skip
        self.plots = [
            new_plot(title, "Time [s]", label, x_range=(0, 1), y_range=(0, 1))
            for title, label in zip(titles, labels, strict=True)
        ]
        self._sets = [CurveSet(plot, "time", "", "t [s]") for plot in self.plots]

    def show(self, now: Picture, kept: Picture | None) -> None:
        """Show the steps; their figures are those of the corners."""
        bare = now.setting.path == "with" and not now.steps.along
        where = "corners, without path" if bare else "corners"
        for number, one in enumerate(self._sets):
            time, values = _step(now, number)
            one.show(time, values)
            reach(one.plot.x_range, 0.0, float(time[-1]))
            reach(one.plot.y_range, max(float(values.min()), -3.0), min(float(values.max()), 3.0))
            one.keep(*(_step(kept, number) if kept is not None else (None, None)))
            highest = float(np.abs(values).max())
            if number == 2:
                self.titles.note(one.plot, f"Load step: up to {highest:.3g} mm/kN ({where})")
            else:
                name = ("Velocity", "Position")[number]
                over = max(100 * (float(values.max()) - 1), 0.0)
                self.titles.note(one.plot, f"{name} step: overshoot up to {over:.0f} % ({where})")


def _step(shown: Picture, number: int) -> tuple[FloatArray, FloatArray]:
    found = (shown.steps.velocity, shown.steps.position, shown.steps.load)[number]
    return found.time, found.value * (1e6 if number == 2 else 1.0)
