"""How far a command is, in plain lines: every ten seconds where no bar can move; how long it took.

The times of the stages are told with ``-v``.
"""

from __future__ import annotations

import sys
import threading
import time
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

EVERY = 10.0  # s, between lines
_MEASURABLE = 0.02  # share of a stage from which the rest of it is estimated

_verbose = ContextVar("verbose", default=False)


def be_verbose(asked: bool) -> bool:
    """Let the present command tell at its end how long its stages took, if that is asked for."""
    _verbose.set(asked)
    return asked


class Stages:
    """What has been reported of each stage, and when it began.

    A stage that comes again, as another part of the same work, goes on where it was: its times add
    up.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._begun = self._first = clock()
        self._stage, self._share = "", 0.0
        self._spent: dict[str, float] = {}
        self._worked: dict[str, float] = {}
        self._processor = time.process_time()

    def take(self, stage: str, share: float) -> None:
        """Take note of how far a stage is."""
        if stage != self._stage:
            self._close()
            self._stage, self._begun = stage, self._clock()
        self._share = share

    def line(self) -> str:
        """Return the stage, its share, and the time: since the command began, and left of it."""
        now = self._clock()
        text = f"{self._stage or 'starting'}, {now - self._first:.0f} s"
        if not _MEASURABLE <= self._share < 1:
            return text
        left = (now - self._begun) * (1 / self._share - 1)
        return f"{text}: {100 * self._share:.0f} % of it, about {left:.0f} s left of it"

    def durations(self) -> dict[str, tuple[float, float]]:
        """Return how long each stage took, in the order in which they began.

        Beside it the time that the processor's cores worked meanwhile, added up [s], for whatever
        the command does beside the stage as well: other programs prolong the former alone.
        """
        self._close()
        return {stage: (spent, self._worked[stage]) for stage, spent in self._spent.items()}

    def _close(self) -> None:
        if self._stage:
            now, worked = self._clock(), time.process_time()
            for times, more in (
                (self._spent, now - self._begun),
                (self._worked, worked - self._processor),
            ):
                times[self._stage] = times.get(self._stage, 0.0) + more
            self._begun, self._processor = now, worked
        else:
            self._processor = time.process_time()


@contextmanager
def telling(*, quiet: bool, every: float = EVERY) -> Iterator[Stages]:
    """Yield stages that are told on stderr: as they go where it is no terminal, and with ``-v``.

    Parameters
    ----------
    quiet
        Tell nothing as they go.
    every
        Time between lines [s].
    """
    stages, ended = Stages(), threading.Event()

    def tell() -> None:
        while not ended.wait(every):
            _say(stages.line())

    teller = threading.Thread(target=tell, daemon=True)
    if not quiet and not _on_terminal():
        teller.start()
    try:
        yield stages
    finally:
        ended.set()
        if teller.is_alive():
            teller.join()
    if _verbose.get():
        for stage, (spent, worked) in stages.durations().items():
            _say(f"{stage}: {spent:.1f} s, {worked:.1f} s of the processor")


def _on_terminal() -> bool:
    return sys.stderr is not None and not sys.stderr.closed and sys.stderr.isatty()


def _say(text: str) -> None:
    """Write a line; a stream that is closed or not there is no reason to end the work."""
    if sys.stderr is not None:
        with suppress(OSError, ValueError):
            sys.stderr.write(f"mptune: {text}\n")
            sys.stderr.flush()
