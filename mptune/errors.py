"""What goes wrong, in words that say how to mend it."""

from __future__ import annotations

from dataclasses import dataclass

_LONGEST = {"where": 300, "key": 100, "value": 100, "rule": 600, "remedy": 600}  # characters
_MOST_FAULTS, _MOST_BYTES = 12, 3500  # of one message; what a screen and a log's line bear


class MptuneError(Exception):
    """The base of every error that mptune raises on purpose."""


@dataclass(frozen=True)
class Fault:
    """One thing wrong with an input: what it is, the rule it breaks and the remedy.

    Attributes
    ----------
    key
        The dotted name of the value, ``oil.bulk_modulus``; empty when the whole file is at fault.
    value
        The value as it was read, for print; empty when there is none.
    rule
        The rule that the value breaks.
    remedy
        What to write instead.
    where
        The file that wrote the value, where it is another than the error as a whole names.
    """

    key: str
    value: str
    rule: str
    remedy: str
    where: str = ""

    def __str__(self) -> str:
        """Return the fault in one line, each part cut to what a line bears."""
        key, value, rule, remedy = (
            shortened(getattr(self, name), _LONGEST[name])
            for name in ("key", "value", "rule", "remedy")
        )
        subject = f"`{key}`" if key else ""
        if value:
            subject = f"{subject} = {value}" if subject else value
        return f"{subject + ' ' if subject else ''}{rule}; {remedy}"


def shortened(text: str, longest: int) -> str:
    """Return a text of at most about so many characters, and of a longer one how long it is."""
    return text if len(text) <= longest else f"{text[:longest]}… ({len(text)} characters)"


class InputError(MptuneError):
    """A file, a key or an option that cannot be used as it stands.

    Parameters
    ----------
    where
        The file, or the option, at fault.
    faults
        Every fault found, so that a user mends them in one go. The message holds the first few of
        many, and says how many there are.
    """

    def __init__(self, where: object, *faults: Fault) -> None:
        self.where = str(where)
        self.faults = faults
        super().__init__("\n".join(self._lines()))

    def _lines(self) -> list[str]:
        lines: list[str] = []
        room = _MOST_BYTES
        for fault in self.faults[:_MOST_FAULTS]:
            line = f"{shortened(fault.where or self.where, _LONGEST['where'])}: {fault}"
            room -= len(line.encode(errors="replace"))
            if lines and room < 0:
                break
            lines.append(line)
        more = len(self.faults) - len(lines)
        return [*lines, f"and {more} more of the kind; mend these first"] if more else lines


class OutputError(MptuneError):
    """A result that could not be written: nothing was left half-written."""
