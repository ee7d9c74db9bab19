"""The page: what stands where. It shows what it is told, and knows no theory."""

from __future__ import annotations

from importlib import resources
from typing import TYPE_CHECKING, Any

import panel as pn
from bokeh.models import CustomJS
from bokeh.models.widgets import Toggle

from mptune.explore.chain_view import ChainView
from mptune.explore.controls import Controls
from mptune.explore.looks import DARK, LIGHT, dress
from mptune.explore.loop_views import LoopsView
from mptune.explore.move_view import MoveView
from mptune.explore.setting import LOOPS, PLANTS
from mptune.explore.sides_view import SidesView
from mptune.explore.steps_view import StepsView

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.explore.setting import Value

VIEWS = ("Inequalities and steps", "Loops", "Machine and chain")
_DRESS = """
const theme = toggle.active ? 'dark' : 'light';
document.documentElement.dataset.theme = theme;
"""
_AT_FIRST = """
toggle.active = window.matchMedia('(prefers-color-scheme: dark)').matches;
document.documentElement.lang = 'en';
const name = root => {
  const title = root.querySelector('.bk-slider-title')?.textContent;
  const handles = title ? root.querySelectorAll('.noUi-handle') : [];
  handles.forEach((handle, n) => handle.setAttribute(
    'aria-label', handles.length > 1 ? title + [', least', ', largest'][n] : title));
  for (const element of root.querySelectorAll('*'))
    if (element.shadowRoot) name(element.shadowRoot);
};
name(document);
"""
_COPY = "navigator.clipboard.writeText(%s)"
_BODY = """
:host { display: grid !important; grid-template-columns: minmax(300px, 360px) minmax(0, 1fr);
  gap: 12px; align-items: start; }
:host > * { min-width: 0 !important; max-width: 100%; }
@media (max-width: 1000px) { :host { grid-template-columns: 270px minmax(0, 1fr); } }
@media (max-width: 640px) { :host { grid-template-columns: minmax(0, 1fr); } }
"""
_PLOTS = """
:host { display: grid !important; gap: 8px 12px;
  grid-template-columns: repeat(auto-fill, minmax(min(100%, 390px), 1fr)); }
:host > * { min-width: 0 !important; }
"""
_SIDE = """
:host { position: sticky; top: 4px; max-height: calc(100vh - 8px); overflow-y: auto; }
@media (max-width: 640px) { :host { position: static; max-height: none; } }
"""


def style(name: str) -> str:
    """Return one of the style sheets that stand beside this file."""
    return resources.files("mptune.explore").joinpath(name).read_text(encoding="utf-8")


class Page:
    """Everything on the page.

    Parameters
    ----------
    studies, sets
        Names of the studies and of the first one's uncertainty sets.
    turned
        Told what a hand turns, see ``mptune.explore.controls.KnobRow``.
    gains_path
        Where gains are saved unless another path is typed.
    """

    def __init__(
        self,
        studies: list[str],
        sets: list[str],
        turned: Callable[[str, Value], None],
        gains_path: str,
    ) -> None:
        self._unseen: dict[str, tuple[str, Callable[[], None]]] = {}
        self.controls = Controls(turned)
        self.sides, self.steps, self.loops = SidesView(), StepsView(), LoopsView()
        self.move, self.chain = MoveView(), ChainView()
        self.study = _select("Study", studies)
        self.set = _select("Uncertainty set", sets)
        self.plant = _select("Chosen plant", list(PLANTS))
        self.loop = _select("Loop", list(LOOPS))
        self.path = _select("Measurement path", ["without", "with"])
        self.kind = _select("Estimator", ["filters", "state"])
        self.buttons = {name: _button(name, tip) for name, tip in _BUTTONS.items()}
        self.gains_path = pn.widgets.TextInput(
            name="Gains file", value=gains_path, sizing_mode="stretch_width", margin=(2, 8)
        )
        self.over = self.buttons["Write over it"]
        self.over.visible = False
        self.toml = pn.widgets.TextAreaInput(
            name="As a study has them",
            height=150,
            sizing_mode="stretch_width",
            disabled=True,
            stylesheets=[".bk-input[disabled] { opacity: 1; cursor: text; }"],
        )
        self.view = pn.widgets.RadioButtonGroup(
            name="View", options=list(VIEWS), value=VIEWS[0], button_type="primary",
            button_style="outline", margin=(4, 8),
        )  # fmt: skip
        self.verdict, self.lamps, self.work, self.message, self.moved = (_words() for _ in range(5))
        self.theme = Toggle(label="Dark", active=False, width=64)
        self.theme.on_change("active", lambda _attr, _old, _new: self.dress())
        self.theme.js_on_change("active", CustomJS(args={"toggle": self.theme}, code=_DRESS))
        self._copies()
        self.panes = {
            VIEWS[0]: _plots(*self.sides.plots, *self.steps.plots),
            VIEWS[1]: _plots(*self.loops.plots),
            VIEWS[2]: pn.Column(
                self.moved, _plots(*self.move.plots, *self.chain.plots), sizing_mode="stretch_width"
            ),
        }
        self.view.param.watch(self._turn_over, "value")
        self._turn_over()
        self.dress()
        self.root = self._laid_out()

    @property
    def plots(self) -> list[Any]:
        """Every plot."""
        views = (self.sides, self.steps, self.loops, self.move, self.chain)
        return [plot for view in views for plot in view.plots]

    def settle(self) -> None:
        """Say in the titles what the plots show, once a slider rests."""
        seen = {
            VIEWS[0]: (self.sides, self.steps),
            VIEWS[1]: (self.loops,),
            VIEWS[2]: (self.move, self.chain),
        }
        for view in seen[self.view.value]:
            view.titles.settle()

    def when_seen(self, view: str, plots: str, show: Callable[[], None]) -> None:
        """Let plots show something once their view is chosen, the last that they were given.

        A browser lays plots out anew even where nobody sees them.
        """
        self._unseen[plots] = (view, show)
        self._catch_up()

    def _catch_up(self) -> None:
        for plots, (view, show) in list(self._unseen.items()):
            if view == self.view.value:
                del self._unseen[plots]
                show()

    def dress(self) -> None:
        """Give every plot the colours of the theme."""
        for plot in self.plots:
            dress(plot, DARK if self.theme.active else LIGHT)

    def at_first(self) -> CustomJS:
        """Return what the browser runs once: it takes the system's theme and names handles."""
        return CustomJS(args={"toggle": self.theme}, code=_AT_FIRST)

    def _turn_over(self, *_: Any) -> None:
        for name, pane in self.panes.items():
            pane.visible = name == self.view.value
        self._catch_up()
        self.settle()

    def _copies(self) -> None:
        """Let two buttons copy: the gains as TOML, the address with the state in it."""
        self.buttons["Copy TOML"].js_on_click(args={"area": self.toml}, code=_COPY % "area.value")
        self.buttons["Copy address"].js_on_click(code=_COPY % "window.location.href")

    def _laid_out(self) -> pn.Column:
        buttons = self.buttons
        title = pn.pane.HTML("<h1>mptune explore</h1>", stylesheets=[style("inner.css")])
        tools = pn.FlexBox(
            title, self.study, self.set,
            *(buttons[name] for name in ("Undo", "Redo", "Keep as A", "Swap A and B", "Reset")),
            pn.pane.Bokeh(self.theme, margin=4),
            align_items="end", sizing_mode="stretch_width",
        )  # fmt: skip
        groups = list(self.controls.groups.values())
        groups[2].insert(0, self.kind)
        save = pn.Card(
            self.gains_path,
            pn.FlexBox(*(buttons[name] for name in _SAVING)),
            self.toml,
            title="Save and share", collapsed=True, sizing_mode="stretch_width",
        )  # fmt: skip
        tuning = pn.FlexBox(buttons["Tune from here"], buttons["Stop"])
        side = pn.Column(
            *groups[:1], tuning, *groups[1:], save,
            sizing_mode="stretch_width", stylesheets=[_SIDE],
        )  # fmt: skip
        looks = pn.FlexBox(self.view, self.plant, self.loop, self.path, align_items="end")
        main = pn.Column(
            self.verdict, self.work, self.message, self.lamps, looks, *self.panes.values(),
            sizing_mode="stretch_width",
        )  # fmt: skip
        body = pn.Column(side, main, sizing_mode="stretch_width", stylesheets=[_BODY])
        return pn.Column(tools, body, sizing_mode="stretch_width", margin=(4, 12))


_SAVING = ("Save", "Write over it", "Save figures", "Copy TOML", "Copy address")
_BUTTONS = {
    "Undo": "Back to before the last change",
    "Redo": "The change that was undone, again",
    "Keep as A": "Keep this setting as A; what is turned from here is B",
    "Swap A and B": "Show A; what was shown becomes A",
    "Reset": "Back to what the study says: the published gains",
    "Tune from here": "Run the tuner from where the sliders stand",
    "Stop": "Stop the tuner, or whatever runs",
    "Save": "Write gains.toml with the verdicts of the linear models and of the machine",
    "Write over it": "Write over the file that exists",
    "Save figures": "Write the certified sweep's figures as SVG beside the gains",
    "Copy TOML": "Copy the gains as a study has them",
    "Copy address": "Copy the address of this setting",
}


def _select(name: str, options: list[str]) -> pn.widgets.Select:
    return pn.widgets.Select(name=name, options=options, width=160, margin=(2, 8))


def _button(name: str, tip: str) -> pn.widgets.Button:
    kind = "primary" if name in {"Tune from here", "Save"} else "default"
    return pn.widgets.Button(
        name=name, button_type=kind, margin=(4, 4), description=tip, align="end"
    )


def _words() -> pn.pane.HTML:
    return pn.pane.HTML(
        "", sizing_mode="stretch_width", stylesheets=[style("inner.css")], margin=(2, 8)
    )


def _plots(*plots: Any) -> pn.Column:
    grid = pn.Column(
        *(pn.pane.Bokeh(plot, sizing_mode="stretch_width") for plot in plots),
        sizing_mode="stretch_width", stylesheets=[_PLOTS],
    )  # fmt: skip
    return pn.Column(grid, sizing_mode="stretch_width")  # which can be hidden: a grid shows itself
