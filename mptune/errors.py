"""What goes wrong, in words that say how to mend it."""

from __future__ import annotations

from dataclasses import dataclass


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
        """Return the fault in one line."""
        subject = f"`{self.key}`" if self.key else ""
        if self.value:
            subject = f"{subject} = {self.value}" if subject else self.value
        return f"{subject + ' ' if subject else ''}{self.rule}; {self.remedy}"


class InputError(MptuneError):
    """A file, a key or an option that cannot be used as it stands.

    Parameters
    ----------
    where
        The file, or the option, at fault.
    faults
        Every fault found, so that a user mends them in one go.
    """

    def __init__(self, where: object, *faults: Fault) -> None:
        self.where = str(where)
        self.faults = faults
        super().__init__("\n".join(f"{fault.where or self.where}: {fault}" for fault in faults))


class OutputError(MptuneError):
    """A result that could not be written: nothing was left half-written."""
