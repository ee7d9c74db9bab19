"""Ctrl-C during work that other processes share.

Python raises an interrupt wherever the main thread is, and drops it there if that is a destructor.
Workers get the same signal from the terminal, and their end may be noticed first. Neither may keep
a campaign from stopping. And numba does not bear an interrupt while it compiles or loads a kernel:
the process may crash. A first Ctrl-C waits for the kernel's end, a second one does not.
"""

from __future__ import annotations

import signal
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import FrameType


_GLANCE = 0.02  # s, between looks at whether a kernel is still being compiled


@contextmanager
def interruptible() -> Iterator[Callable[[], None]]:
    """Yield a function that raises the interrupt that has come, if one was dropped before.

    Raises
    ------
    KeyboardInterrupt
        On Ctrl-C, whatever error it showed up as.
    """
    asked = False

    def interrupt(_number: int, frame: FrameType | None) -> None:
        nonlocal asked
        first, asked = not asked, True
        sys.unraisablehook = lambda *_: None  # what is torn apart half-made complains in vain
        if not first or not _put_off(frame):
            raise KeyboardInterrupt

    def check() -> None:
        if asked:
            raise KeyboardInterrupt

    before, hook = signal.signal(signal.SIGINT, interrupt), sys.unraisablehook
    try:
        yield check
    except Exception as error:
        if asked:
            raise KeyboardInterrupt from error
        raise
    finally:
        signal.signal(signal.SIGINT, before)
        sys.unraisablehook = hook


def _put_off(frame: FrameType | None) -> bool:
    """Raise the interrupt as soon as numba has done, if it is at work now."""
    if not _in_numba(frame) or not hasattr(signal, "setitimer"):
        return False

    def again(_number: int, frame: FrameType | None) -> None:
        if _in_numba(frame):
            return
        signal.setitimer(signal.ITIMER_REAL, 0)
        raise KeyboardInterrupt

    signal.signal(signal.SIGALRM, again)
    signal.setitimer(signal.ITIMER_REAL, _GLANCE, _GLANCE)
    return True


def _in_numba(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_globals.get("__name__", "").startswith(("numba", "llvmlite")):
            return True
        frame = frame.f_back
    return False
