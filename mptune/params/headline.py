"""The words of a verdict, which stand first wherever gains are spoken of."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable


class Headline(StrEnum):
    """How gains came out, in order of precedence: the first that applies is said."""

    UNDECIDED = "undecided"  # a written requirement is, or the stability of the loop
    NOT_MET = "not met"  # a written requirement is violated
    ON_PAPER = "met on paper only"  # but a model that was run is unstable, or short of gain
    MET = "met"

    @classmethod
    def first(cls, words: Iterable[Headline]) -> Headline:
        """Return the one that takes precedence; *met* where there are none."""
        order = list(cls)
        return min(words, key=order.index, default=cls.MET)
