"""Where the sliders have been: undo and redo, and two settings that are kept to be compared."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mptune.explore.setting import HandSetting

_DEEPEST = 200  # settings that can be undone


@dataclass(frozen=True)
class History:
    """The present setting, those before and after it, and the one kept as A.

    Attributes
    ----------
    now
        What the page shows.
    past, future
        What undo and redo go back and forth to, the nearest last.
    kept
        The setting kept as A, beside which the present one is B; None where none is kept.
    """

    now: HandSetting
    past: tuple[HandSetting, ...] = ()
    future: tuple[HandSetting, ...] = ()
    kept: HandSetting | None = None

    def to(self, setting: HandSetting) -> History:
        """Return the history after a change; what had been undone is forgotten."""
        if setting == self.now:
            return self
        return replace(self, now=setting, past=(*self.past, self.now)[-_DEEPEST:], future=())

    def undone(self) -> History:
        """Return the history one change back; as it is where there is none."""
        if not self.past:
            return self
        return replace(
            self, now=self.past[-1], past=self.past[:-1], future=(*self.future, self.now)
        )

    def redone(self) -> History:
        """Return the history one change forth again; as it is where there is none."""
        if not self.future:
            return self
        return replace(
            self, now=self.future[-1], past=(*self.past, self.now), future=self.future[:-1]
        )

    def keeping(self) -> History:
        """Return the history with the present setting kept as A."""
        return replace(self, kept=self.now)

    def swapped(self) -> History:
        """Return the history with A and B in each other's place; as it is without an A."""
        if self.kept is None:
            return self
        return replace(self.to(self.kept), kept=self.now)
