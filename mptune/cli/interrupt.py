"""Ctrl-C during work that other processes share.

Python raises an interrupt wherever the main thread is, and drops it there if that is a destructor.
Workers get the same signal from the terminal, and their end may be noticed first. Neither may keep
a campaign from stopping.
"""

from __future__ import annotations

import signal
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import FrameType


@contextmanager
def interruptible() -> Iterator[Callable[[], None]]:
    """Yield a function that raises the interrupt that has come, if one was dropped before.

    Raises
    ------
    KeyboardInterrupt
        On Ctrl-C, whatever error it showed up as.
    """
    asked = False

    def interrupt(_number: int, _frame: FrameType | None) -> None:
        nonlocal asked
        asked = True
        raise KeyboardInterrupt

    def check() -> None:
        if asked:
            raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, interrupt)
    try:
        yield check
    except Exception as error:
        if asked:
            raise KeyboardInterrupt from error
        raise
    finally:
        signal.signal(signal.SIGINT, before)
