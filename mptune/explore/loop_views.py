"""Bode and Nyquist plots of one loop, with circles of constant |S|, and its sensitivities."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.explore.looking import CHOSEN, NOMINAL
from mptune.explore.looks import HEIGHT, Titles, decades, hover, line, link, new_plot, show_kept
from mptune.explore.plotted import CurveSet, source

if TYPE_CHECKING:
    from bokeh.plotting import figure

    from mptune.explore.picture import Picture

_FREQUENCY = "Frequency [rad/s]"
_PEAKS = (1.3, 2.0, 4.0)  # circles of |S|
_FLOOR = 1e-2


class LoopsView:
    """The chosen loop: Bode, Nyquist, |S| and |T|."""

    def __init__(self) -> None:
        self.titles = Titles()
        log = {"x_axis_type": "log"}
        self._magnitude = new_plot(
            "Magnitude", _FREQUENCY, "|L| [dB]", **log, y_range=(-40, 40), x_range=(0.5, 500)
        )
        self._phase = new_plot("Phase", _FREQUENCY, "arg L [°]", **log, y_range=(-540, -60))
        self._size = new_plot(
            "Sensitivity", _FREQUENCY, "|S| [–]", **log, y_axis_type="log", y_range=(0.02, 12)
        )
        self._rest = new_plot(
            "Complementary sensitivity", _FREQUENCY, "|T| [–]", **log, y_axis_type="log",
            y_range=(0.02, 12),
        )  # fmt: skip
        self._nyquist = new_plot(
            "Nyquist", "Re L [–]", "Im L [–]", height=HEIGHT + 60, match_aspect=True,
            x_range=(-3.2, 1.2), y_range=(-2.4, 1.4),
        )  # fmt: skip
        for plot in (self._size, self._rest):
            decades(plot)
        tip = "ω [rad/s]"
        self._sets = [
            CurveSet(self._magnitude, "omega", "dB", tip),
            CurveSet(self._phase, "omega", "°", tip),
            CurveSet(self._size, "omega", "", tip),
            CurveSet(self._rest, "omega", "", tip),
        ]
        along = [self._magnitude, self._phase, self._size, self._rest]
        link(along)
        self.plots: list[figure] = [*along, self._nyquist]
        self._fill_nyquist()

    def _fill_nyquist(self) -> None:
        plot, turn = self._nyquist, np.linspace(0, 2 * np.pi, 120)
        for peak in _PEAKS:  # |1 + L| = 1/|S|
            circle = {"x": -1 + np.cos(turn) / peak, "y": np.sin(turn) / peak}
            data = source("x", "y")
            data.data = circle
            line(plot, data, "x", "y", "limit", line_width=0.8)
        top = source("x", "y", "words")
        top.data = {
            "x": [-1.0] * len(_PEAKS),
            "y": [1 / peak for peak in _PEAKS],
            "words": [f"|S| = {peak:g}" for peak in _PEAKS],
        }
        words = plot.text("x", "y", "words", source=top, text_font_size="10px", text_align="center",
                          y_offset=-2)  # fmt: skip
        words.tags = ["limit"]
        point = plot.scatter([-1], [0], marker="cross", size=12, line_width=2)
        point.tags = ["limit"]
        self._corners = source("xs", "ys")
        corners = plot.multi_line("xs", "ys", source=self._corners, line_width=0.6, line_alpha=0.6)
        corners.tags = ["edge"]
        self._curves = {name: source("x", "y", "omega", "size", "plant")
                        for name in ("nominal", "chosen", "kept")}  # fmt: skip
        labels = {"nominal": "nominal", "chosen": "chosen plant", "kept": "A"}
        drawn = [
            line(plot, data, "x", "y", name, legend_label=labels[name])
            for name, data in self._curves.items()
        ]
        tips = [("plant", "@plant"), ("ω", "@omega{0.000} rad/s"), ("L", "@x{0.000} + @y{0.000} j"),
                ("|S|", "@size{0.000}")]  # fmt: skip
        hover(plot, drawn, tips)

    def show(self, now: Picture, kept: Picture | None) -> None:
        """Show the loop."""
        for one, (values, floor) in zip(self._sets, _figures(now), strict=True):
            one.show(now.loops.omega, values, floor)
        others = _figures(kept) if kept is not None else None
        for number, one in enumerate(self._sets):
            omega = kept.loops.omega if kept is not None else None
            one.keep(omega, others[number][0] if others else None)
        peak = float(now.loops.sensitivity[CHOSEN].max())
        self.titles.note(self._size, f"Sensitivity: up to {peak:.3g} with the chosen plant")
        far = float(now.loops.complementary[CHOSEN].max())
        self.titles.note(self._rest, f"Complementary sensitivity: up to {far:.3g}")
        self._show_nyquist(now, kept)

    def _show_nyquist(self, now: Picture, kept: Picture | None) -> None:
        self._curves["nominal"].data = _curve(now, NOMINAL)
        self._curves["chosen"].data = _curve(now, CHOSEN)
        empty: dict[str, object] = {name: [] for name in ("x", "y", "omega", "size", "plant")}
        show_kept(self._nyquist, shown=kept is not None)
        self._curves["kept"].data = _curve(kept, CHOSEN) if kept is not None else empty
        gain = _gain(now)[2:, ::2]
        self._corners.data = {"xs": list(gain.real), "ys": list(gain.imag)}


def _figures(shown: Picture) -> list[tuple[np.ndarray, float | None]]:
    loops = shown.loops
    return [
        (loops.decibel, None),
        (loops.degrees, None),
        (loops.sensitivity, _FLOOR),
        (loops.complementary, _FLOOR),
    ]


def _gain(shown: Picture) -> np.ndarray:
    """Return the loop gains, no farther off than any window."""
    gain = shown.loops.gain
    return gain * np.minimum(1.0, 50 / np.maximum(np.abs(gain), 1e-12))


def _curve(shown: Picture, row: int) -> dict[str, object]:
    gain, name = _gain(shown)[row], shown.looked.names[row]
    return {
        "x": gain.real,
        "y": gain.imag,
        "omega": shown.loops.omega,
        "size": shown.loops.sensitivity[row],
        "plant": [name] * len(gain),
    }
