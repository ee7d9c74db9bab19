"""The controller as C99: fixed sources, and the study's numbers as constant data."""

from __future__ import annotations

from importlib import resources
from typing import TYPE_CHECKING

import numpy as np

from mptune.escaping import c_string, comment_text
from mptune.export.formats import Precision
from mptune.force.search_space import search_space

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mptune.arrays import IntArray
    from mptune.export.controller import TargetController

FLAGS = ("-std=c99", "-O2", "-ffp-contract=off")
_CONSTANTS = """\
#ifndef MPTUNE_PARAMETERS_H
#define MPTUNE_PARAMETERS_H

#include <stdint.h>

#define MPTUNE_SINGLE_PRECISION {single}
#define MPTUNE_TICKS {ticks}U /* T_S / T_S,fast: steps per decision */
#define MPTUNE_STATES {states}U /* valve states of one side, Eq. 6 */
#define MPTUNE_CANDIDATES {candidates}U /* pairs looked at two periods ahead; at least 1 */
#define MPTUNE_MARGINS_SATISFIED {trusted} /* 0 where the export was forced */
#define MPTUNE_VERDICT "{verdict}"
#define MPTUNE_STUDY_HASH "{hash}"
#define MPTUNE_VERSION "{version}"
#define MPTUNE_DATE "{date}"

#if MPTUNE_SINGLE_PRECISION
typedef float mptune_real;
#else
typedef double mptune_real;
#endif

/* The study's numbers, SI. */
typedef struct {{
{members}
}} mptune_parameters;

/* What a valve state of one side connects: a supply, and in crossflow its neighbour. */
typedef struct {{
    uint8_t first;        /* supply, 0 lowest to 5 highest */
    uint8_t first_count;  /* its open valves */
    uint8_t second;
    uint8_t second_count; /* 0 without crossflow */
}} mptune_port;

#ifdef __cplusplus
extern "C" {{
#endif

extern const mptune_parameters mptune_study;
extern const mptune_port mptune_ports[MPTUNE_STATES];
extern const uint8_t mptune_valves[MPTUNE_STATES][12];                /* 1 where open */
extern const uint8_t mptune_switches[MPTUNE_STATES][MPTUNE_STATES]; /* valves that differ */

#ifdef __cplusplus
}}
#endif

#endif
"""
_DATA = """\
#include "mptune_parameters.h"

const mptune_parameters mptune_study = {{
{values}
}};

/* Eq. 6, generated from its rule */
const mptune_port mptune_ports[MPTUNE_STATES] = {{
{ports}
}};

const uint8_t mptune_valves[MPTUNE_STATES][12] = {{
{valves}
}};

const uint8_t mptune_switches[MPTUNE_STATES][MPTUNE_STATES] = {{
{switches}
}};
"""


def c_sources(controller: TargetController) -> dict[str, str]:
    """Return every file of the controller in C by its name."""
    comment = c_comment(controller.heading("Numbers of one study, written by mptune."))
    folder = resources.files("mptune.export").joinpath("c")
    fixed = {
        item.name: item.read_text("utf-8")
        for item in sorted(folder.iterdir(), key=lambda item: item.name)
        if item.name.endswith((".c", ".h"))
    }
    stamp = c_comment(controller.heading("Written by mptune."))
    return {name: stamp + text for name, text in fixed.items()} | {
        "mptune_parameters.h": comment + _constants(controller),
        "mptune_parameters.c": comment + _data(controller),
    }


def c_comment(lines: Iterable[str]) -> str:
    """Return lines as one comment that no text in them can end or nest."""
    safe = map(comment_text, lines)
    return "/*\n" + "".join(f" * {line}".rstrip() + "\n" for line in safe) + " */\n"


def _constants(controller: TargetController) -> str:
    numbers, provenance = controller.numbers, controller.provenance()
    members = (
        f"    mptune_real {one.key}; /* {one.unit if one.unit != '1' else '-'}, {one.meaning} */"
        for one in numbers.all()
    )
    return _CONSTANTS.format(
        single=int(numbers.precision is Precision.FLOAT),
        ticks=numbers.ticks,
        states=len(search_space().first),
        candidates=max(round(numbers.value("candidates")), 1),
        trusted=int(controller.trusted),
        verdict=c_string(controller.word),
        hash=c_string(provenance["study_hash"]),
        version=c_string(provenance["version"]),
        date=c_string(provenance["date"]),
        members="\n".join(members),
    )


def _data(controller: TargetController) -> str:
    space = search_space()
    numbers = controller.numbers
    single = numbers.precision is Precision.FLOAT
    values = (
        f"    .{one.key} = {_literal(one.value, single=single)}, /* {one.value.hex()} */"
        for one in numbers.all()
    )
    columns = (space.first, space.first_count, space.second, space.second_count)
    ports = np.stack(columns, axis=1).astype(np.int64)
    return _DATA.format(
        values="\n".join(values),
        ports="\n".join(_rows(ports)),
        valves="\n".join(_rows(space.valves)),
        switches="\n".join(_rows(space.switches.astype(np.int64))),
    )


def _literal(value: float, *, single: bool) -> str:
    """Return the shortest literal that reads back as exactly this value."""
    return f"{np.float32(value)!s}F" if single else repr(value)


def _rows(table: IntArray) -> Iterator[str]:
    for row in table:
        yield "    {" + ", ".join(f"{value}U" for value in row) + "},"
