"""The chain of gain factors, drawn: a bar from 1 to each model's factor."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from bokeh.models import FactorRange
from bokeh.models.annotations import Span

from mptune.explore.looks import Titles, hover, new_plot
from mptune.explore.plotted import source
from mptune.robust.chain import factor_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bokeh.plotting import figure

    from mptune.robust.chain import Link

_LOW, _HIGH = 0.5, 4.0  # ends of the axis of factors; bars end there


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
