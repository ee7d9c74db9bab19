"""A study whose short forms are taken for what they stand for, and what it needs and has not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.errors import Fault
from mptune.params.chambers import plain_sections
from mptune.params.lines import supplies_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mptune.params.study import Study

ADD_IT = "add it to the study"


def long_form(study: Study) -> Study:
    """Return the study with what its chambers and lines say instead of other sections."""
    changed = plain_sections(study.chambers, study.cylinder, study.hose)
    return study.model_copy(
        update={"supplies": supplies_of(study.lines, study.supplies), **changed}
    )


def missing(keys: Iterable[str]) -> list[Fault]:
    """Return a fault for each dotted key that is asked for and not there."""
    return [Fault(key, "", "is missing", ADD_IT) for key in keys]
