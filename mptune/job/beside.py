"""The machines of other studies in a comparison: each as its study has it, and with its tuner's."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.errors import Fault, InputError
from mptune.params.beside import on_the_load_of
from mptune.params.load import load_study

if TYPE_CHECKING:
    from mptune.params.study import ResolvedStudy


def studies_beside(study: ResolvedStudy) -> tuple[ResolvedStudy, ...]:
    """Return the studies that a study's ``[systems]`` names beside its own.

    Raises
    ------
    InputError
        If one cannot be read.
    """
    found = []
    for path in study.study.systems.beside:
        try:
            found.append(load_study(path))
        except InputError as error:
            first = error.faults[0]
            reason = f"{first.key} {first.rule}".lstrip()
            rule = f"names a study that cannot be taken: {reason}"
            remedy = (
                "mend it or its name, which is taken from the folder of the study that wrote it"
            )
            raise InputError(study.name, Fault("systems.beside", path, rule, remedy)) from error
    for other in found:
        on_the_load_of(study, other)  # refuses what cannot be run, before anything is
    return tuple(found)
