"""Studies that another one is compared with: ``[systems] beside``, and their machines on its load.

A list of study files. They are named while a study is loaded and read where the comparison is made,
so that a study can be worked with whatever has become of its neighbours. What they name beside
themselves is not followed.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from mptune.errors import Fault, InputError
from mptune.params.coherence import refusals_of
from mptune.params.extent import faults_of_extent
from mptune.units import shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mptune.params.layers import Layers
    from mptune.params.study import ResolvedStudy

_KEY = "systems.beside"


def name_beside(layers: Layers) -> None:
    """Take the names under ``systems.beside`` from the folder of the study that wrote them.

    The study itself is left out of its own list, where a base may have put it. What is no list of
    file names is left as it is, to be refused with the rest of the study.
    """
    systems: Any = layers.values.get("systems")
    names = systems.get("beside") if isinstance(systems, dict) else None
    if not isinstance(names, list) or not all(map(_names_a_file, names)):
        return
    folder = layers.folder_of(_KEY)
    paths = dict.fromkeys(os.path.normpath(folder / name) for name in names)
    own = os.path.realpath(layers.files[-1])
    systems["beside"] = [path for path in paths if os.path.realpath(path) != own]


def _names_a_file(name: Any) -> bool:
    return isinstance(name, str) and bool(name.strip()) and "\0" not in name


def on_the_load_of(study: ResolvedStudy, other: ResolvedStudy) -> ResolvedStudy:
    """Return another study's machine and controller under a study's load, moves and cases.

    Its valves stay its own, with their delays.

    Raises
    ------
    InputError
        If that cannot be simulated: the moves leave the other's stroke, say.
    """
    asked, valves = study.study.verification, other.study.verification.valve_delays
    same = {
        "load": study.study.load,
        "manoeuvre": study.study.manoeuvre,
        "verification": asked.model_copy(update={"valve_delays": valves}),
    }
    moved = other.model_copy(update={"study": other.study.model_copy(update=same)})
    written = frozenset(asked.model_fields_set)
    faults = [*_beyond_the_stroke(moved), *refusals_of(moved.study, written)]
    faults += faults_of_extent(moved)
    if faults:
        raise InputError(f"{other.name} under the load and the moves of {study.name}", *faults)
    return moved


def _beyond_the_stroke(moved: ResolvedStudy) -> Iterator[Fault]:
    least, largest = moved.study.reach()
    stroke = moved.study.cylinder.stroke
    if least < 0 or largest > stroke:
        reach = shown((least, largest), "m", ranged=True)
        rule = f"is left by the moves, which reach {reach}"
        yield Fault("cylinder.stroke", shown(stroke, "m"), rule, f"take the study off {_KEY}")
