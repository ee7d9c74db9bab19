"""What is done for machines of two chambers only."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.errors import Fault, InputError
from mptune.params.chambers import NUMBERS

if TYPE_CHECKING:
    from mptune.params.study import ResolvedStudy


def needs_two_chambers(study: ResolvedStudy, what: str, remedy: str) -> None:
    """Refuse what is done for two chambers only.

    Raises
    ------
    InputError
        Naming ``what``.
    """
    count = len(study.study.all_chambers)
    if count > NUMBERS[0]:
        rule = f"are more than two, for which there is no {what}"
        raise InputError(study.name, Fault("chambers", str(count), rule, remedy))
