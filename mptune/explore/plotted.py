"""What every plot of curves holds: the nominal plant, the chosen one, the corners' band, and A."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from bokeh.models import ColumnDataSource

from mptune.explore.looking import CHOSEN, NOMINAL
from mptune.explore.looks import band, hover, line, show_kept

if TYPE_CHECKING:
    from bokeh.plotting import figure

    from mptune.arrays import FloatArray

_CORNERS = 2  # first row of the corners


def source(*columns: str) -> ColumnDataSource:
    """Return a source of empty columns."""
    return ColumnDataSource({name: [] for name in columns})


def fill(kept: ColumnDataSource, data: dict[str, Any]) -> None:
    """Fill a source; one that is empty and stays so is not sent anew."""
    if any(map(len, (*kept.data.values(), *data.values()))):
        kept.data = data


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
        fill(self.kept, {self._x: [], "chosen": []} if empty else _chosen(self._x, x, values))


def _chosen(name: str, x: Any, values: Any) -> dict[str, Any]:
    return {name: x, "chosen": values[CHOSEN]}
