"""What follows when a slider rests, and what a hand asks for: none of it holds up the page.

The chain on the corners takes some 50 ms and is made at once. One move on the machine runs in a
thread, its kernel without Python's lock; the certified verdict, tuning and saving in a process.
Each is overtaken by the next of its kind.
"""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mptune.errors import InputError
from mptune.explore import words
from mptune.explore.move import SimulatedMove, simulated_move
from mptune.explore.page import VIEWS
from mptune.explore.worker import Worker, WorkerMessage
from mptune.files import is_there

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.explore.jobs import Ask, CertifiedFigures, TunedSetting
    from mptune.explore.page import Page
    from mptune.explore.picture import Picture
    from mptune.params.study import ResolvedStudy

_STAGES = {"certify": "Certifying over the whole box", "tune": "Tuning",
           "verify": "Running the nonlinear machine",
           "figures": "Drawing", "chain": "Gain factors"}  # fmt: skip
_BY_HAND = {"tuned", "saved", "drawn"}


class SlowWork:
    """Slow work of one tab.

    Parameters
    ----------
    page
        What shows it.
    later
        Runs an action on the tab's own turn; any thread may ask.
    """

    def __init__(self, page: Page, later: Callable[[Callable[[], None]], None]) -> None:
        self._page, self._later = page, later
        self._worker = Worker(later)
        self._threads = ThreadPoolExecutor(max_workers=1)
        self._moving: Future[None] | None = None
        self._published: dict[str, SimulatedMove] = {}
        self._job = ""

    @property
    def worker(self) -> Worker:
        """The process for what takes seconds."""
        return self._worker

    def certify(self, ask: Ask, done: Callable[[CertifiedFigures], None]) -> None:
        """Ask for the certified verdict, unless tuning or saving runs."""
        if not (self._worker.busy and self._job in _BY_HAND):
            self._start("certified", (ask,), done)

    def tune(self, ask: Ask, done: Callable[[TunedSetting], None]) -> None:
        """Tune; whatever runs is overtaken."""
        self._start("tuned", (ask,), done)

    def save(self, ask: Ask, done: Callable[[], None], *, over: bool) -> None:
        """Save the gains with both verdicts; over a file that exists only where that is meant."""
        page = self._page
        path = Path(page.gains_path.value or "")
        try:
            page.over.visible = there = is_there(path)
        except InputError as error:
            page.message.object = words.said(str(error), wrong=True)
            return
        if there and not over:
            text = f"{path} exists: write over it, or choose another name."
            page.message.object = words.said(text, wrong=True)
            return

        def saved(verdicts: str) -> None:
            page.over.visible = True
            page.message.object = words.said(f"{path} written: {verdicts}.")
            done()

        self._start("saved", (ask, path.resolve(), over), saved)

    def draw(self, ask: Ask, out: Path, done: Callable[[], None]) -> None:
        """Write the figures of the certified sweep into a folder of their own."""

        def drawn(folder: Path) -> None:
            self._page.message.object = words.said(f"Figures written into {folder}.")
            done()

        self._start("drawn", (ask, out.resolve()), drawn)

    def stop(self) -> None:
        """Stop what runs in the process."""
        self._worker.stop()
        self._page.work.object = ""
        self._page.message.object = words.said("Stopped.")

    def move(
        self, published: ResolvedStudy, now: Picture, still: Callable[[Picture], bool]
    ) -> None:
        """Simulate a move in a thread; it is drawn if the picture is ``still`` what is shown."""
        if self._moving is not None:
            self._moving.cancel()
        mass = float(now.looked.plants.mass[1])
        key = f"{published.name} {published.hash()} {mass!r}"
        known = self._published.get(key)

        def simulate() -> None:
            before = known or simulated_move(published, mass)
            after = simulated_move(now.study, mass)
            self._later(lambda: moved(before, after))

        def moved(before: SimulatedMove, after: SimulatedMove) -> None:
            self._published = {key: before}
            if still(now):
                self._page.when_seen(VIEWS[2], "move", lambda: self._page.move.show(after, before))
                self._page.settle()
                self._page.moved.object = words.moves(after.words, before.words)

        self._moving = self._threads.submit(simulate)

    def close(self) -> None:
        """End everything."""
        self._worker.end()
        self._threads.shutdown(wait=False, cancel_futures=True)

    def _start(self, kind: str, arguments: tuple[Any, ...], done: Callable[[Any], None]) -> None:
        self._job = kind

        def heard(message: WorkerMessage) -> None:
            page = self._page
            if message.what == "progress":
                stage, share = message.content
                page.work.object = words.working(_STAGES.get(stage, stage), share or None)
                return
            page.work.object = ""
            if message.what == "failed":
                page.message.object = words.said(message.content, wrong=True)
            else:
                done(message.content)

        self._worker.start(kind, arguments, heard)
        if kind in _BY_HAND:
            self._page.message.object = ""
        self._page.work.object = words.working("Starting", None)
