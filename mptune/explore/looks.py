"""The look of the page's plots: the report's roles, in light and dark, told apart in grey too."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from bokeh.models import CrosshairTool, HoverTool
from bokeh.models.annotations import Legend, Span
from bokeh.plotting import figure

if TYPE_CHECKING:
    from collections.abc import Iterable


class Palette(NamedTuple):
    """Colours by role."""

    ground: str
    ink: str
    quiet: str  # labels of axes
    grid: str
    nominal: str
    chosen: str
    band: str
    edge: str
    kept: str
    limit: str


LIGHT = Palette(
    "#ffffff", "#1a1a1a", "#4a4a4a", "#dddddd", "#0072b2", "#d55e00", "#9ecae1", "#4a7ea8",
    "#00785a", "#000000",
)  # fmt: skip
DARK = Palette(
    "#16191d", "#e8e8e8", "#b4bac2", "#343a41", "#56b4e9", "#ff8a3d", "#2c5f80", "#7fb0d4",
    "#3ddc97", "#ffffff",
)  # fmt: skip

LOOKS: dict[str, dict[str, Any]] = {
    "nominal": {"line_width": 1.6},
    "chosen": {"line_width": 1.8, "line_dash": "dashdot"},
    "edge": {"line_width": 0.8, "line_alpha": 0.8},
    "kept": {"line_width": 1.6, "line_dash": "dotted"},
    "limit": {"line_width": 1.5, "line_dash": "dashed"},
}
"""How lines of each role are drawn; their colours are the palette's."""

HEIGHT = 270  # px


def new_plot(title: str, x: str, y: str, **kwargs: Any) -> figure:
    """Return an empty plot as wide as its place, with pan, wheel, box zoom, reset and saving."""
    options: dict[str, Any] = {"height": HEIGHT, **kwargs}
    plot = figure(
        title=title,
        x_axis_label=x,
        y_axis_label=y,
        sizing_mode="stretch_width",
        min_width=280,
        tools="pan,box_zoom,wheel_zoom,reset,save",
        toolbar_location="above",
        output_backend="canvas",
        **options,
    )
    plot.toolbar.logo = None
    plot.toolbar.autohide = True
    plot.min_border_right = 12
    heading: Any = plot.title
    heading.text_font_size = "13px"
    plot.add_layout(Legend(orientation="horizontal", location="left"), "below")
    return plot


class Titles:
    """Titles that wait until a slider rests: another title lays the whole plot out anew."""

    def __init__(self) -> None:
        self._waiting: dict[str, tuple[figure, str]] = {}

    def note(self, plot: figure, text: str) -> None:
        """Take note of a plot's next title."""
        self._waiting[plot.id] = (plot, text)

    def settle(self) -> None:
        """Give every plot the title that it waits for."""
        for plot, text in self._waiting.values():
            title: Any = plot.title
            title.text = text
        self._waiting.clear()


def reach(axis: Any, low: float, high: float) -> None:
    """Let the range of an axis hold two values; it stays where that leaves no more than twice."""
    span = high - low
    held = axis.start <= low and high <= axis.end
    if not held or axis.end - axis.start > 2.2 * span:
        axis.update(start=low - 0.05 * span, end=high + 0.12 * span)


def decades(plot: figure) -> None:
    """Let a logarithmic y axis say a few values in each decade."""
    plot.yaxis.ticker = [m * 10.0**n for n in range(-4, 5) for m in (1, 2, 5)]


def show_kept(plot: figure, *, shown: bool) -> None:
    """Let the legend name the setting kept as A where there is one."""
    for legend in plot.legend:
        items: list[Any] = legend.items
        for item in items:
            if item.label.value == "A":
                item.visible = shown


def hover(plot: figure, renderers: Iterable[Any], tips: list[tuple[str, str]]) -> None:
    """Show values under the pointer, at the lines given."""
    plot.add_tools(
        HoverTool(renderers=list(renderers), tooltips=tips, mode="mouse", line_policy="nearest")
    )


def link(plots: Iterable[figure], *, x: bool = True) -> None:
    """Let plots share the range of their x axes, and a line at the pointer's x."""
    plots = list(plots)
    span = Span(dimension="height", line_dash="dotted", line_width=1, line_color="#888888")
    for plot in plots:
        if x:
            plot.x_range = plots[0].x_range
        plot.add_tools(CrosshairTool(overlay=span, dimensions="height"))


def line(plot: figure, source: Any, x: str, y: str, role: str, **kwargs: Any) -> Any:
    """Draw a line in one of the roles."""
    drawn = plot.line(x, y, source=source, **{**LOOKS[role], **kwargs})
    drawn.tags = [role]
    return drawn


def band(plot: figure, source: Any, x: str, low: str, high: str, label: str) -> None:
    """Draw the band between two curves."""
    drawn = plot.varea(x, low, high, source=source, fill_alpha=0.5, legend_label=label)
    drawn.tags = ["band"]


def dress(plot: figure, palette: Palette) -> None:
    """Give a plot the colours of a palette."""
    plot.background_fill_color = plot.border_fill_color = palette.ground
    plot.outline_line_color = palette.grid
    title: Any = plot.title
    title.text_color = palette.ink
    for axis in plot.axis:
        axis.axis_label_text_color = axis.major_label_text_color = palette.quiet
        axis.axis_label_text_font_style = "normal"
        axis.axis_line_color = axis.major_tick_line_color = palette.quiet
        axis.minor_tick_line_color = palette.grid
    for grid in plot.grid:
        grid.grid_line_color = palette.grid
    legends: list[Any] = list(plot.legend)
    for legend in legends:
        legend.background_fill_color, legend.label_text_color = palette.ground, palette.ink
        legend.border_line_color, legend.label_text_font_size = None, "11px"
        legend.padding, legend.spacing, legend.margin = 0, 14, 0
        legend.glyph_width, legend.label_standoff = 26, 4
        legend.click_policy = "hide"
    for drawn in plot.renderers:
        for role in getattr(drawn, "tags", ()):
            _colour(drawn, getattr(palette, role))


def _colour(drawn: Any, colour: str) -> None:
    for glyph in (drawn.glyph, drawn.nonselection_glyph, drawn.muted_glyph):
        for name in ("line_color", "fill_color", "text_color"):
            if hasattr(glyph, name):
                setattr(glyph, name, colour)
