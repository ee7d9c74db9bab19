"""The plots: both inequalities and the steps; the loops. Each takes a picture and shows it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from bokeh.models import ColumnDataSource

from mptune.explore.looking import CHOSEN, NOMINAL
from mptune.explore.looks import band, decades, hover, line, link, new_plot, show_kept
from mptune.robust.place import plant_point
from mptune.robust.tables import EQUATIONS

if TYPE_CHECKING:
    from bokeh.plotting import figure

    from mptune.arrays import FloatArray
    from mptune.explore.picture import Picture

_CORNERS = 2  # first row of the corners
_FREQUENCY = "Frequency [rad/s]"
_LOWEST = 1e-3  # lower end of a band on a logarithmic axis


class View(Protocol):
    """Plots that show a picture, and the picture kept as A beside it."""

    plots: list[figure]

    def show(self, now: Picture, kept: Picture | None) -> None:
        """Show a picture."""


def source(*columns: str) -> ColumnDataSource:
    """Return a source of empty columns."""
    return ColumnDataSource({name: [] for name in columns})


class SidesView:
    """Both sides of Eq. 17 and Eq. 21, with the plant that binds at each frequency."""

    def __init__(self) -> None:
        self.plots: list[figure] = []
        self._data, self._kept, self._worst = [], [], []
        for name in ("velocity", "position"):
            plot = new_plot(
                EQUATIONS[name], _FREQUENCY, "Magnitude [–]", x_axis_type="log", y_axis_type="log"
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
            self._kept[loop].data = _sides_of(kept, loop)
            show_kept(plot, shown=kept is not None)
            equation = EQUATIONS[("velocity", "position")[loop]]
            plot.title.text = (
                f"{equation}: worst ratio {ratio:.4f} at {at.frequency_rad_s:.1f} rad/s (grid)"
            )
            top = max(2 * float(found.left[loop].max()), 12.0)
            plot.y_range.start, plot.y_range.end = max(float(found.left[loop, 0]) / 4, 0.02), top


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


class CurveSet:
    """Nominal and chosen plant and the corners' band, in one plot."""

    def __init__(
        self, plot: figure, x: str, value: str, x_tip: str, *, spread: bool = True
    ) -> None:
        self._x = x
        self.plot = plot
        self.data = source(x, "low", "high", "nominal", "chosen")
        self.kept = source(x, "chosen")
        if spread:
            band(plot, self.data, x, "low", "high", "corners")
        drawn = [
            line(plot, self.data, x, "nominal", "nominal", legend_label="nominal"),
            line(plot, self.data, x, "chosen", "chosen", legend_label="chosen plant"),
        ]
        line(plot, self.kept, x, "chosen", "kept", legend_label="A")
        tips = [(x_tip, f"@{x}{{0.000}}"), ("value", f"@$name{{0.0000}} {value}")]
        for name, renderer in zip(("nominal", "chosen"), drawn, strict=True):
            renderer.name = name
        hover(plot, drawn, [("plant", "$name"), *tips])

    def show(self, x: FloatArray, values: FloatArray, floor: float | None = None) -> None:
        """Show ``(P, X)`` values; the band ends at ``floor`` where that is given."""
        corners = values[_CORNERS:]
        low = corners.min(axis=0) if floor is None else np.maximum(corners.min(axis=0), floor)
        self.data.data = {
            self._x: x,
            "low": low,
            "high": corners.max(axis=0),
            "nominal": values[NOMINAL],
            "chosen": values[CHOSEN],
        }

    def keep(self, x: FloatArray | None, values: FloatArray | None) -> None:
        """Show the chosen plant of the setting kept as A, or nothing."""
        empty = x is None or values is None
        show_kept(self.plot, shown=not empty)
        self.kept.data = {self._x: [], "chosen": []} if empty else _chosen(self._x, x, values)


def _chosen(name: str, x: Any, values: Any) -> dict[str, Any]:
    return {name: x, "chosen": values[CHOSEN]}


class StepsView:
    """Steps of velocity and position, and of the load."""

    def __init__(self) -> None:
        titles = ("Velocity step", "Position step", "Load step")
        labels = ("Velocity over its reference [–]", "Position over its reference [–]",
                  "Position [mm/kN]")  # fmt: skip
        self.plots = [
            new_plot(title, "Time [s]", label) for title, label in zip(titles, labels, strict=True)
        ]
        self._sets = [CurveSet(plot, "time", "", "t [s]") for plot in self.plots]

    def show(self, now: Picture, kept: Picture | None) -> None:
        """Show the steps; their figures are those of the corners."""
        for number, one in enumerate(self._sets):
            time, values = _step(now, number)
            one.show(time, values)
            one.keep(*(_step(kept, number) if kept is not None and kept.steps else (None, None)))
            highest = float(np.abs(values).max())
            if number == 2:
                one.plot.title.text = f"Load step: up to {highest:.3g} mm/kN (corners)"
            else:
                name = ("Velocity", "Position")[number]
                over = max(100 * (float(values.max()) - 1), 0.0)
                one.plot.title.text = f"{name} step: overshoot up to {over:.0f} % (corners)"


def _step(shown: Picture, number: int) -> tuple[FloatArray, FloatArray]:
    if shown.steps is None:
        raise ValueError("a picture without steps")
    found = (shown.steps.velocity, shown.steps.position, shown.steps.load)[number]
    return found.time, found.value * (1e6 if number == 2 else 1.0)
