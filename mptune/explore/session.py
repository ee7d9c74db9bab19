"""One tab: what a hand turns becomes a setting, a setting becomes figures, quick ones and slow.

While a slider moves the grid's figures follow, each event overtaking those before it. When it rests
the setting enters the history and the address, and three more things follow: the chain on the
corners, one move on the machine (in a thread), and the certified verdict (in a process).
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import panel as pn

from mptune.errors import MptuneError
from mptune.explore import words
from mptune.explore.history import History
from mptune.explore.page import VIEWS, Page
from mptune.explore.pause import WhenPausing
from mptune.explore.picture import Picture, picture
from mptune.explore.setting import KIND, HandSetting
from mptune.explore.slow_work import SlowWork
from mptune.explore.study_text import as_toml

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from mptune.explore.jobs import CertifiedFigures, TunedSetting
    from mptune.explore.library import Library
    from mptune.explore.setting import Value
    from mptune.robust.chain import Link

_REST = 300  # ms without an event, after which a slider rests
_FOLLOW = 150  # ms without an event, after which lamps and steps follow
_LATEST = 0.5  # s, after which they follow anyway
_WAITING = "grid figures; the certified verdict follows when the sliders rest"
_PREPARING = "preparing; on first use kernels are compiled, which takes a minute"


class Session:
    """One tab's state and what it does.

    Parameters
    ----------
    library
        The studies that are offered.
    out
        The folder for results.
    query
        The part of the tab's address behind the question mark.
    """

    def __init__(self, library: Library, out: Path, query: str = "") -> None:
        self._library, self._document, self._out = library, pn.state.curdoc, out
        setting, wrong = self._first(query)
        self._history, self._shown = History(setting), setting
        self._study = library.load(setting.study, setting.uncertainty)
        self._now: Picture | None = None
        self._kept: Picture | None = None
        self._proved: CertifiedFigures | None = None
        self._drawing = False  # a drawing is on its way
        self._broken = False  # what the knobs say is no study
        self._resting = WhenPausing(self._document, self._rest, _REST)
        self._following = WhenPausing(self._document, self._follow, _FOLLOW, _LATEST)
        self._say_next = ""  # beside the next picture
        self._quiet = False  # widgets are being placed, nobody turned them
        name = setting.study or library.names[0]
        gains = out / name / "gains.toml"
        self.page = Page(library.names, library.sets(setting.study), self._turned, str(gains))
        self._slow = SlowWork(self.page, self._later)
        self._wire()
        self._place()
        self.page.verdict.object = words.verdict(None, _PREPARING)
        self.page.message.object = words.said(wrong, wrong=True)
        self._draw_soon()
        if self._document is not None:
            self._document.js_on_event("document_ready", self.page.at_first())
        self._resting.soon()

    def _first(self, query: str) -> tuple[HandSetting, str]:
        """Return the setting that an address says, or none and what is wrong with it."""
        default = HandSetting(uncertainty=self._library.uncertainty)
        try:
            setting = HandSetting.from_query(query) if query else default
            study = self._library.load(setting.study, setting.uncertainty)
            setting.put_over(study)
        except MptuneError as error:
            return default, str(error)
        return setting, ""

    def _wire(self) -> None:
        page, buttons = self.page, self.page.buttons
        views = ((page.plant, "plant"), (page.loop, "loop"), (page.path, "path"))
        for widget, name in views:
            widget.param.watch(partial(self._look, name), "value")
        page.kind.param.watch(lambda event: self._turned(KIND, event.new), "value")
        page.study.param.watch(lambda event: self._choose(event.new, ""), "value")
        page.set.param.watch(lambda event: self._choose(self._shown.study, event.new), "value")
        page.view.param.watch(lambda _: self._draw_soon(), "value")
        actions: dict[str, Callable[[], None]] = {
            "Undo": lambda: self._go(self._settled().undone()),
            "Redo": lambda: self._go(self._settled().redone()),
            "Keep as A": self._keep,
            "Swap A and B": lambda: self._go(self._settled().swapped()),
            "Reset": lambda: self._go(self._settled().to(self._shown.published())),
            "Tune from here": self._tune,
            "Stop": self._slow.stop,
            "Save": self._save,
            "Save figures": self._save_figures,
            "Write over it": partial(self._save, over=True),
        }
        for name, action in actions.items():
            buttons[name].on_click(partial(_act, action))

    # Turning.

    def _turned(self, key: str, value: Value) -> None:
        if self._quiet:
            return
        self._shown = self._shown.turn(key, value, self._study)
        self._draw_soon()
        self._following.soon()
        self._resting.soon()

    def _look(self, name: str, event: Any) -> None:
        if not self._quiet:
            self._shown = self._shown.looking(**{name: event.new})
            self._keep_picture()
            self._draw_soon()
            self._resting.soon()

    def _choose(self, study: str, uncertainty: str) -> None:
        if self._quiet:
            return
        named = "" if self._library.is_named(study) else study
        chosen = HandSetting(study=named, uncertainty=uncertainty, plant=self._shown.plant)
        self._go(self._history.to(chosen))

    def _go(self, history: History) -> None:
        """Show another setting of the history."""
        before, self._history, self._shown = self._shown, history, history.now
        try:
            self._study = self._library.load(self._shown.study, self._shown.uncertainty)
        except MptuneError as error:
            self.page.message.object = words.said(str(error), wrong=True)
            self._history = replace(history, now=before)
            self._shown = before
        self._place()
        self._keep_picture()
        self._draw_soon()
        self._resting.soon()

    def _keep(self) -> None:
        self._history = self._settled().keeping()
        self._keep_picture()
        self._draw_soon()

    def _keep_picture(self) -> None:
        kept = self._history.kept
        self._kept = None
        if kept is not None:
            study = self._library.load(kept.study, kept.uncertainty)
            shown = self._shown
            alike = kept.looking(plant=shown.plant, loop=shown.loop, path=shown.path)
            self._kept = picture(study, alike)

    def _place(self) -> None:
        """Let every widget stand where the setting has it."""
        page, shown = self.page, self._shown
        self._quiet = True
        try:
            page.controls.place(shown, self._study)
            page.study.value = shown.study or self._library.names[0]
            page.set.options = {one or "default": one for one in self._library.sets(shown.study)}
            page.set.value = shown.uncertainty
            page.plant.value, page.loop.value = shown.plant, shown.loop
            page.path.value = shown.path
            page.kind.value = dict(shown.turned).get(KIND, self._study.study.estimator.kind)
        finally:
            self._quiet = False

    # Drawing.

    def _draw_soon(self) -> None:
        """Draw once all events that have come are heard."""
        if not self._drawing:
            self._drawing = True
            self._later(self._draw)

    def _draw(self) -> None:
        self._drawing = False
        view = self.page.view.value
        try:
            found = picture(self._study, self._shown)
        except MptuneError as error:
            self._broken = True
            self.page.message.object = words.said(str(error), wrong=True)
            return
        if self._broken or self._now is None or found.study != self._now.study:
            self._proved = None
            self.page.message.object, self._say_next = words.said(self._say_next), ""
            self.page.verdict.object = words.verdict(None, _WAITING)
        self._now, self._broken = found, False
        with pn.io.hold():
            if view == VIEWS[0]:
                self.page.sides.show(found, self._kept)
            elif view == VIEWS[1]:
                self.page.loops.show(found, self._kept)
        if self._document is None:
            self._follow()
        self._following.soon()

    def _follow(self) -> None:
        """Let lamps and steps follow the curves: a browser draws slowly."""
        if self._now is None or self._broken:
            return
        with pn.io.hold():
            self._show_lamps()
            if self.page.view.value == VIEWS[0]:
                self.page.steps.show(self._now, self._kept)

    def _show_lamps(self) -> None:
        if self._now is None:
            return
        proved = self._proved.checks if self._proved else ()
        kept = self._kept.checks if self._kept else ()
        self.page.lamps.object = words.lamps(self._now.checks, proved, kept)

    # At rest.

    def _settled(self) -> History:
        """Enter what is shown into history and address; return the history."""
        self._history = self._history.to(self._shown)
        if pn.state.location is not None:
            query = self._shown.query()
            pn.state.location.search = f"?{query}" if query else ""
        return self._history

    def _rest(self) -> None:
        if self._drawing:
            self._draw()
        if self._now is None or self._broken:
            return
        self._settled()
        page, now = self.page, self._now
        page.toml.value = as_toml(now.study, [key for key, _ in self._shown.turned])
        if self._proved is None:
            self._show_chain(now.chain(), "corners, on a grid")
            self._slow.certify(
                self._library.ask(self._shown), lambda found: self._certified(now, found)
            )
        page.settle()
        self._slow.move(self._study, now, self._is_shown)

    def _show_chain(self, links: tuple[Link, ...], grounds: str) -> None:
        page = self.page
        page.when_seen(VIEWS[2], "chain", lambda: page.chain.show(links, grounds))

    def _is_shown(self, found: Picture) -> bool:
        return self._now is not None and found.study == self._now.study

    def _certified(self, of: Picture, found: CertifiedFigures) -> None:
        if not self._is_shown(of):
            return
        self._proved = found
        self.page.verdict.object = words.verdict(found.judgement, "")
        self._show_chain(found.links, "certified")
        self.page.settle()
        self._show_lamps()

    # By hand.

    def _tune(self) -> None:
        self._settled()
        self._slow.tune(self._library.ask(self._shown), self._tuned)

    def _tuned(self, found: TunedSetting) -> None:
        values: dict[str, Value] = dict(found.values)
        tuned = self._shown.gains_from(values, self._study)
        self._go(self._history.to(tuned))
        self._say_next = found.words

    def _save(self, *, over: bool = False) -> None:
        self._settled()
        self._slow.save(self._library.ask(self._shown), self._resting.soon, over=over)

    def _save_figures(self) -> None:
        self._settled()
        self._slow.draw(self._library.ask(self._shown), self._out, self._resting.soon)

    # The end.

    def _later(self, action: Callable[[], None]) -> None:
        """Run an action on the tab's own turn; any thread may ask."""
        if self._document is not None and self._document.session_context is not None:
            self._document.add_next_tick_callback(action)
        elif self._document is None:
            action()

    def close(self) -> None:
        """End what runs for this tab."""
        self._slow.close()


def _act(action: Callable[[], None], _click: Any) -> None:
    action()
