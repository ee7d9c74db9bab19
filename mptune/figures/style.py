"""One style for every figure: readable in grey and by the colour-blind, SI units on the axes.

The same thing has the same look everywhere: the family a grey-blue band, the worst plant a
vermilion dash-dotted line, the nominal plant a solid blue one, a limit or right-hand side black
and dashed, a reference dotted.
"""

from __future__ import annotations

import contextlib
import io
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from mptune.arrays import FloatArray

BAND: dict[str, Any] = {"color": "#9ecae1", "linewidth": 0, "alpha": 0.65}
EDGE: dict[str, Any] = {"color": "#4a7ea8", "linewidth": 0.7}
NOMINAL: dict[str, Any] = {"color": "#0072b2", "linewidth": 1.4}
WORST: dict[str, Any] = {"color": "#d55e00", "linewidth": 1.5, "linestyle": "-."}
LIMIT: dict[str, Any] = {"color": "black", "linewidth": 1.3, "linestyle": "--"}
REFERENCE: dict[str, Any] = {"color": "black", "linewidth": 0.9, "linestyle": ":"}
SECOND: dict[str, Any] = {"color": "#009e73", "linewidth": 1.4, "linestyle": "--"}

WIDTH = 6.9  # inches, the width of a page's text

_FAR = 1e9  # where a curve that has left every picture is drawn

_SETTINGS: dict[str, Any] = {
    "font.size": 8.5,
    "axes.titlesize": 9,
    "axes.titleweight": "bold",
    "axes.grid": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": "#d9d9d9",
    "grid.linewidth": 0.5,
    "legend.fontsize": 7.5,
    "legend.frameon": True,
    "legend.framealpha": 0.9,
    "legend.edgecolor": "none",
    "svg.hashsalt": "mptune",
}


@contextlib.contextmanager
def style() -> Iterator[None]:
    """Return the context in which figures are drawn.

    What the library has to say of letters that its font lacks, or of axes without extent, is kept
    from the user: the figure shows it.
    """
    import matplotlib as mpl

    settings: Any = _SETTINGS
    with mpl.rc_context(settings), warnings.catch_warnings():
        warnings.filterwarnings("ignore", category=UserWarning)
        yield


MEASURED = {"filters": "with measurement path", "estimator": "with state estimator"}
"""Words for what measures, by the name of its path."""


def new_figure(height: float) -> Figure:
    """Return an empty figure as wide as a page's text; ``height`` in inches."""
    from matplotlib.figure import Figure

    return Figure(figsize=(WIDTH, height), layout="constrained")


def to_svg(figure: Figure) -> bytes:
    """Return a figure as SVG, the same bytes for the same figure."""
    buffer = io.BytesIO()
    with style():
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()


def to_png(figure: Figure, dots_per_inch: int = 160) -> bytes:
    """Return a figure as PNG."""
    buffer = io.BytesIO()
    with style():
        figure.savefig(buffer, format="png", dpi=dots_per_inch, metadata={"Software": None})
    return buffer.getvalue()


def legend_below(figure: Figure, *axes: Axes, columns: int = 5) -> None:
    """Put one legend for all the axes below the figure, where it covers no data.

    Long labels ask for fewer ``columns`` at most.
    """
    entries: dict[str, Any] = {}
    for one in axes:
        for handle, label in zip(*one.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    rows = -(-len(entries) // columns)
    figure.legend(
        list(entries.values()),
        list(entries),
        loc="outside lower center",
        ncols=-(-len(entries) // rows),
        handlelength=3,
    )


def drawable(curves: FloatArray) -> FloatArray:
    """Return curves that an axis can hold: what runs away, or beyond all numbers, stays far off."""
    far = np.nan_to_num(curves, nan=_FAR, posinf=_FAR, neginf=-_FAR)
    return np.asarray(np.clip(far, -_FAR, _FAR))


def band(axes: Axes, x: FloatArray, curves: FloatArray, label: str) -> None:
    """Draw a family of curves ``(N, T)`` as the band between its smallest and largest values."""
    low, high = curves.min(axis=0), curves.max(axis=0)
    axes.fill_between(x, low, high, label=label, **BAND)
    axes.plot(x, low, **EDGE)
    axes.plot(x, high, **EDGE)
