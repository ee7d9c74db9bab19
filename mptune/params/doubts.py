"""What may be meant otherwise than written: said, and carried on with."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Doubt:
    """Values of a study that can be simulated, but hardly fit one another.

    Attributes
    ----------
    keys
        The dotted names of the values, the one to look at first.
    values
        Each of them for print, in the keys' order.
    rule
        What is doubtful about them, with numbers.
    remedy
        What to write instead, where it is not meant so.
    """

    keys: tuple[str, ...]
    values: tuple[str, ...]
    rule: str
    remedy: str

    def __str__(self) -> str:
        """Return the doubt in one line."""
        pairs = zip(self.keys, self.values, strict=True)
        subject = ", ".join(f"`{key}` = {value}" for key, value in pairs)
        return f"{subject}: {self.rule}; {self.remedy}"

    @property
    def brief(self) -> str:
        """The doubt without its remedy, the first of its values alone."""
        return f"{self.keys[0]} = {self.values[0]}: {self.rule}"

    def json(self) -> dict[str, object]:
        """Return the doubt with its values by key."""
        values = dict(zip(self.keys, self.values, strict=True))
        return {"values": values, "rule": self.rule, "remedy": self.remedy}
