"""A process for slow work: one job at a time, each overtaken by the next, the page never waiting.

A thread could not be stopped, and would share Python's lock and the kernels' threads with the hand
that turns. A process is ended, and the next one is started while the sliders move.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable
    from multiprocessing.connection import Connection
    from multiprocessing.context import SpawnProcess

_POLITE = 5  # added to the niceness: the page goes first
_CONTEXT = multiprocessing.get_context("spawn")


class WorkerMessage(NamedTuple):
    """A message of a job: ``"progress"`` with stage and share, ``"done"``, or ``"failed"``."""

    what: str
    content: Any


class Worker:
    """Slow work of one tab.

    Parameters
    ----------
    tell
        Runs a function where the page's models may be touched; it may be called from any thread.
    """

    def __init__(self, tell: Callable[[Callable[[], None]], None]) -> None:
        self._tell = tell
        self._process: SpawnProcess | None = None
        self._pipe: Connection | None = None
        self._number = 0  # of the job that is waited for; messages of earlier ones are dropped
        self._busy = False

    @property
    def busy(self) -> bool:
        """Whether a job is running."""
        return self._busy

    @property
    def process_id(self) -> int | None:
        """The process; None where there is none."""
        return self._process.pid if self._process else None

    def start(
        self, kind: str, arguments: tuple[Any, ...], heard: Callable[[WorkerMessage], None]
    ) -> None:
        """Start a job; one that is still running is ended.

        Parameters
        ----------
        kind, arguments
            As of ``mptune.explore.jobs.run``.
        heard
            Told of what becomes of it, through ``tell``; nothing more once it was overtaken.
        """
        if self._busy or self._process is None or not self._process.is_alive():
            self.end()
            self._pipe, theirs = _CONTEXT.Pipe()
            self._process = _CONTEXT.Process(target=_work, args=(theirs,), daemon=True)
            self._process.start()
            theirs.close()
        self._number += 1
        self._busy = True
        pipe = self._pipe
        if pipe is None:
            raise RuntimeError("a process without a pipe")
        with suppress(OSError):  # the process has just ended: the reader says so
            pipe.send((kind, arguments))
        listen = threading.Thread(target=self._listen, args=(pipe, self._number, heard))
        listen.daemon = True
        listen.start()

    def stop(self) -> None:
        """End the job that is running, if any, and hear no more of it."""
        self._number += 1
        if self._busy:
            self.end()

    def end(self) -> None:
        """End the process; another is started for the next job."""
        self._number += 1
        self._busy = False
        process, self._process = self._process, None
        pipe, self._pipe = self._pipe, None
        if process is not None:
            process.kill()
            process.join()
            process.close()
        if pipe is not None:
            with suppress(OSError):
                pipe.close()

    def _listen(
        self, pipe: Connection, number: int, heard: Callable[[WorkerMessage], None]
    ) -> None:
        """Pass on what a job says, until it is done or its process has ended."""
        while True:
            try:
                message = WorkerMessage(*pipe.recv())
            except (EOFError, OSError, TypeError):  # closed by us, or ended by somebody else
                message = WorkerMessage("failed", "the computation was ended from outside")
            self._tell(partial(self._pass, number, message, heard))
            if message.what != "progress":
                return

    def _pass(
        self, number: int, message: WorkerMessage, heard: Callable[[WorkerMessage], None]
    ) -> None:
        if number != self._number:
            return
        if message.what != "progress":
            self._busy = False
        heard(message)


def _work(pipe: Connection) -> None:
    """Do one job after another, in the process of its own."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the page's: it ends this process
    with suppress(OSError, AttributeError):
        os.nice(_POLITE)
    from mptune.errors import MptuneError
    from mptune.explore import jobs

    def progress(stage: str, share: float) -> None:
        pipe.send(("progress", (stage, share)))

    while True:
        try:
            kind, arguments = pipe.recv()
        except (EOFError, OSError):
            return
        try:
            message = ("done", jobs.run(kind, arguments, progress))
        except MptuneError as error:
            message = ("failed", str(error))
        except Exception as error:  # noqa: BLE001 - said on the page, as the command line says it
            message = ("failed", f"unforeseen error: {type(error).__name__}: {error}")
        try:
            pipe.send(message)
        except OSError:
            return
