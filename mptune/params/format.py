"""The number of a file's format: ``format = 1`` at its top.

What a newer mptune wrote is refused instead of misread; what an older one wrote is read as long
as it can be. Files from before there were numbers have none and are of the first format. The number
is no part of what a file says: no hash holds it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mptune.errors import Fault, InputError

if TYPE_CHECKING:
    from pathlib import Path

FORMAT_KEY, BASE_KEY = "format", "base"
OF_A_FILE = (FORMAT_KEY, BASE_KEY)  # keys that are no part of what a study says
_FIRST = 1


@dataclass(frozen=True)
class Format:
    """The formats of one kind of file that this mptune reads.

    Attributes
    ----------
    newest
        The newest that is read, and the one that is written.
    renew
        What to do about a file older than any that is read.
    oldest
        The oldest that is read.
    """

    newest: int
    renew: str
    oldest: int = _FIRST

    def take(self, path: Path, values: dict[str, Any]) -> int:
        """Take the number out of a file's values; the first where there is none.

        Raises
        ------
        InputError
            If it is no whole number, or not among the formats that are read.
        """
        number = values.pop(FORMAT_KEY, _FIRST)
        if not isinstance(number, int) or isinstance(number, bool):
            rule, remedy = "is no whole number", f"write {FORMAT_KEY} = {self.newest}"
        elif number > self.newest:
            rule = f"is newer than {self.newest}, the newest that this mptune knows"
            remedy = "update mptune"
        elif number < self.oldest:
            rule = f"is older than {self.oldest}, the oldest that this mptune reads"
            remedy = self.renew
        else:
            return number
        raise InputError(path, Fault(FORMAT_KEY, repr(number), rule, remedy))


STUDY_FORMAT = Format(1, "carry its values over into a study from `mptune new NAME`")
GAINS_FORMAT = Format(1, "tune or export it again")
CONTROLLER_FORMAT = 1
"""The format of exported controllers, which are written only."""
