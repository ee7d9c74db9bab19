"""What waits for the hand to pause."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable


class WhenPausing:
    """An action that follows once nothing has asked for it during some time.

    Parameters
    ----------
    document
        The tab's document, whose clock it is; without one nothing follows.
    action
        What follows.
    pause
        Time without being asked [ms].
    latest
        Time after which it follows although it is still being asked [s].
    """

    def __init__(
        self, document: Any, action: Callable[[], None], pause: int, latest: float = math.inf
    ) -> None:
        self._document, self._action = document, action
        self._pause, self._latest = pause, latest
        self._waiting: Any = None
        self._since = 0.0

    def soon(self) -> None:
        """Act when the hand pauses."""
        if self._document is None:
            return
        now = time.monotonic()
        if self._waiting is None:
            self._since = now
        elif now - self._since > self._latest:
            return
        else:
            self._document.remove_timeout_callback(self._waiting)
        self._waiting = self._document.add_timeout_callback(self._act, self._pause)

    def _act(self) -> None:
        self._waiting = None
        self._action()
