"""Progress of long work: one protocol, from the innermost loop to the terminal's bar."""

from __future__ import annotations

from typing import Protocol


class Progress(Protocol):
    """Told how far long work is: the stage's name, and the share of it that is done, 0 to 1."""

    def __call__(self, stage: str, share: float, /) -> None:
        """Take note."""


def silent(_stage: str, _share: float, /) -> None:
    """Take no note."""
