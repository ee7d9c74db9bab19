"""Both sides of Eq. 17 and Eq. 21, drawn, with the plant that binds at each frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.explore.looks import Titles, band, decades, hover, line, link, new_plot, show_kept
from mptune.explore.plotted import fill, source
from mptune.robust.place import plant_point
from mptune.robust.tables import EQUATIONS

if TYPE_CHECKING:
    from bokeh.plotting import figure

    from mptune.explore.picture import Picture

_FREQUENCY = "Frequency [rad/s]"
_LOWEST = 1e-3  # lower end of a band on a logarithmic axis


class SidesView:
    """Both sides of Eq. 17 and Eq. 21, with the plant that binds at each frequency."""

    def __init__(self) -> None:
        self.titles = Titles()
        self.plots: list[figure] = []
        self._data, self._kept, self._worst = [], [], []
        for name in ("velocity", "position"):
            plot = new_plot(
                EQUATIONS[name],
                _FREQUENCY,
                "Magnitude [–]",
                x_axis_type="log",
                y_axis_type="log",
                y_range=(0.1, 12),
            )
            decades(plot)
            data = source("omega", "low", "left", "right", "ratio", "plant")
            kept, worst = source("omega", "left", "right"), source("omega", "left", "ratio")
            band(plot, data, "omega", "low", "left", "family's error |Δ|")
            left = line(plot, data, "omega", "left", "edge", name=f"left-{name}")
            right = line(plot, data, "omega", "right", "limit", legend_label="right-hand side")
            line(plot, kept, "omega", "left", "kept", legend_label="A")
            line(plot, kept, "omega", "right", "kept")
            mark = plot.scatter("omega", "left", source=worst, size=9, marker="diamond")
            mark.tags = ["chosen"]
            tips = [("ω", "@omega{0.000} rad/s"), ("left / right", "@left{0.000} / @right{0.000}"),
                    ("ratio", "@ratio{0.0000}"), ("binding plant", "@plant")]  # fmt: skip
            hover(plot, [left, right], tips)
            self._data.append(data)
            self._kept.append(kept)
            self._worst.append(worst)
            self.plots.append(plot)
        link(self.plots)

    def show(self, now: Picture, kept: Picture | None) -> None:
        """Show both inequalities."""
        for loop, plot in enumerate(self.plots):
            omega, found = now.sides.omega, now.sides.found
            ratio, at = now.sides.worst(loop)
            self._data[loop].data = {
                "omega": omega,
                "low": np.full(len(omega), _LOWEST),
                "left": found.left[loop],
                "right": found.right[loop],
                "ratio": found.ratio[loop],
                "plant": _names(now, found.plant[loop]),
            }
            place = int(np.argmax(found.ratio[loop]))
            self._worst[loop].data = {
                "omega": omega[[place]],
                "left": found.left[loop, [place]],
                "ratio": [ratio],
            }
            fill(self._kept[loop], _sides_of(kept, loop))
            show_kept(plot, shown=kept is not None)
            equation = EQUATIONS[("velocity", "position")[loop]]
            self.titles.note(
                plot,
                f"{equation}: worst ratio {ratio:.4f} at {at.frequency_rad_s:.1f} rad/s (grid)",
            )


def _sides_of(kept: Picture | None, loop: int) -> dict[str, Any]:
    if kept is None:
        return {"omega": [], "left": [], "right": []}
    found = kept.sides.found
    return {"omega": kept.sides.omega, "left": found.left[loop], "right": found.right[loop]}


def _names(now: Picture, rows: Any) -> list[str]:
    """Return the name of the plant behind each value."""
    model = now.sides.model
    known = {
        int(row): plant_point(
            model.whole_family, int(row), float("nan"), model.member_names
        ).headline
        for row in np.unique(rows)
    }
    return [known[int(row)] for row in rows]
