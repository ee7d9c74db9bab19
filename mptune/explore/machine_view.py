"""One move on the nonlinear machine beside the published gains, and the chain of gain factors."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from bokeh.models import FactorRange
from bokeh.models.annotations import Span

from mptune.explore.looks import Titles, hover, line, link, new_plot
from mptune.explore.plotted import source
from mptune.robust.chain import factor_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bokeh.plotting import figure

    from mptune.arrays import FloatArray
    from mptune.explore.move import SimulatedMove
    from mptune.robust.chain import Link

_LOW, _HIGH = 0.5, 4.0  # ends of the axis of factors; bars end there
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


class ChainView:
    """One bar per model, from 1 to the factor by which the gain at F_ref may rise."""

    def __init__(self) -> None:
        self.titles = Titles()
        self._range = FactorRange(factors=[])
        self._plot = new_plot(
            "Chain of gain factors", "Factor on the gain at F_ref [–]", "",
            x_axis_type="log", x_range=(_LOW, _HIGH), y_range=self._range,
        )  # fmt: skip
        self._plot.yaxis.axis_label = None
        self._plot.xaxis.ticker = [0.5, 0.7, 1, 1.5, 2, 3, 4]
        self._data = source("name", "left", "right", "words", "note")
        bars = self._plot.hbar(
            "name", left="left", right="right", height=0.55, source=self._data, fill_alpha=0.75
        )
        bars.tags = ["nominal"]
        words = self._plot.text(
            "right", "name", "words", source=self._data, text_baseline="middle", x_offset=6,
            text_font_size="12px",
        )  # fmt: skip
        words.tags = ["limit"]
        one = Span(location=1.0, dimension="height", line_dash="dashed", line_color="#888888")
        self._plot.add_layout(one)
        hover(self._plot, [bars], [("model", "@name"), ("factor", "@words"), ("", "@note")])
        self.plots: list[figure] = [self._plot]

    def show(self, links: Sequence[Link], grounds: str) -> None:
        """Show links; ``grounds`` says what they rest on."""
        names = [link.name for link in links]
        factors = np.array([link.factor for link in links])
        reach = np.clip(np.nan_to_num(factors, nan=1.0), _LOW, _HIGH / 1.3)
        words = [
            "not stable" if np.isnan(factor) and link.note else factor_text(factor)
            for factor, link in zip(factors, links, strict=True)
        ]
        self._range.factors = names[::-1]
        self._data.data = {
            "name": names,
            "left": np.minimum(1.0, reach),
            "right": np.maximum(1.0, reach),
            "words": words,
            "note": [link.note for link in links],
        }
        self.titles.note(self._plot, f"Chain of gain factors ({grounds})")
