"""The controller as C99: fixed sources, and the study's numbers as constant data."""

from __future__ import annotations

from importlib import resources
from typing import TYPE_CHECKING

import numpy as np

from mptune.escaping import c_string, comment_text
from mptune.export.formats import Precision
from mptune.force.search_space import space_of
from mptune.params.chambers import NUMBERS
from mptune.params.packed import BASE, MADE_BY, RESTS, SHARE

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mptune.export.controller import TargetController

_BYTE = 255  # the most that a byte counts
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off")
_CONSTANTS = """\
#ifndef MPTUNE_PARAMETERS_H
#define MPTUNE_PARAMETERS_H

#include <stdint.h>

#define MPTUNE_SINGLE_PRECISION {single}
#define MPTUNE_TICKS {ticks}U /* T_S / T_S,fast: steps per decision */
#define MPTUNE_LINES {lines}U /* pressures between which each chamber is switched */
#define MPTUNE_CONVERTERS {converters}U /* converter cylinders that make some of them */
#define MPTUNE_PLACES {places}U /* room for their positions: at least 1 */
#define MPTUNE_CHAMBERS {chambers}U /* that push and pull the piston, A first, then B */
#define MPTUNE_FURTHER {further}U /* chambers behind these two */
#define MPTUNE_FURTHER_PLACES {further_places}U /* room for their pressures: at least 1 */
#define MPTUNE_SIGNALS (5U + MPTUNE_CONVERTERS + MPTUNE_FURTHER) /* the samples of mptune_inputs */
#define MPTUNE_VALVES {valves}U /* valves of one chamber: of a line in parallel, line by line */
#define MPTUNE_STATES {states}U /* valve states of one chamber, Eq. 6 */
#define MPTUNE_CANDIDATES {candidates}U /* combinations looked at two periods ahead; at least 1 */
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

typedef {choice} mptune_choice; /* number of a valve state */

/* The study's numbers, SI. */
typedef struct {{
{members}
}} mptune_parameters;

/* What a valve state of one side connects: a line, and in crossflow its neighbour. */
typedef struct {{
    uint8_t first;            /* line, 0 for the lowest pressure */
    mptune_real first_count;  /* its open valves, in K_v */
    uint8_t second;
    mptune_real second_count; /* 0 without crossflow */
}} mptune_port;

/* One chamber. */
typedef struct {{
    mptune_real area;             /* m^2 */
    mptune_real dead;             /* m^3, V_0 + V_h */
    mptune_real hose;             /* m^3, V_h */
    mptune_real flow_coefficient; /* m^3/(s Pa^0.5), K_v of its valves */
    uint8_t pulls;                /* 1 where its pressure pulls the piston in */
}} mptune_size;

/* A line's pressure: its base and a share of the way from there to the highest line. */
typedef struct {{
    mptune_real base;  /* Pa */
    mptune_real share;
    uint8_t rests;     /* 1 where the base is the lowest line's pressure as measured */
    uint8_t converter; /* that makes it; MPTUNE_PLACES for none */
}} mptune_line;

#ifdef __cplusplus
extern "C" {{
#endif

extern const mptune_parameters mptune_study;
extern const mptune_port mptune_ports[MPTUNE_STATES];
extern const mptune_line mptune_lines[MPTUNE_LINES];
extern const mptune_size mptune_chambers[MPTUNE_CHAMBERS];
extern const uint8_t mptune_valves[MPTUNE_STATES][MPTUNE_VALVES];   /* 1 where open */
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

const mptune_line mptune_lines[MPTUNE_LINES] = {{
{lines}
}};

const mptune_size mptune_chambers[MPTUNE_CHAMBERS] = {{
{chambers}
}};

const uint8_t mptune_valves[MPTUNE_STATES][MPTUNE_VALVES] = {{
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
    space, converters = space_of(controller.study), controller.study.study.converters
    states, valves = space.valves.shape
    chambers = len(numbers.chambers)
    members = (
        f"    mptune_real {one.key}; /* {one.unit if one.unit != '1' else '-'}, {one.meaning} */"
        for one in numbers.all()
    )
    return _CONSTANTS.format(
        single=int(numbers.precision is Precision.FLOAT),
        ticks=numbers.ticks,
        lines=space.lines.shape[1],
        converters=converters,
        places=max(converters, 1),
        chambers=chambers,
        further=chambers - NUMBERS[0],
        further_places=max(chambers - NUMBERS[0], 1),
        valves=valves,
        states=states,
        choice="uint8_t" if states <= _BYTE else "uint16_t",
        candidates=max(round(numbers.value("candidates")), 1),
        trusted=int(controller.trusted),
        verdict=c_string(controller.word),
        hash=c_string(provenance["study_hash"]),
        version=c_string(provenance["version"]),
        date=c_string(provenance["date"]),
        members="\n".join(members),
    )


def _data(controller: TargetController) -> str:
    space = space_of(controller.study)
    places = max(controller.study.study.converters, 1)
    numbers = controller.numbers
    single = numbers.precision is Precision.FLOAT
    values = (
        f"    .{one.key} = {_literal(one.value, single=single)}, /* {one.value.hex()} */"
        for one in numbers.all()
    )

    def rows(table: Iterable[Iterable[float]]) -> str:
        return "\n".join(_rows(table, single=single))

    columns = (space.first, space.first_count, space.second, space.second_count)
    lines = space.lines
    made_by = np.where(lines[MADE_BY] < 0, places, lines[MADE_BY])
    described = np.stack([lines[BASE], lines[SHARE], lines[RESTS], made_by], axis=1)
    return _DATA.format(
        values="\n".join(values),
        ports=rows(zip(*columns, strict=True)),
        lines=rows(described),
        chambers=rows([one.value for one in chamber] for chamber in numbers.chambers),
        valves=rows(space.valves),
        switches=rows(space.switches),
    )


def _literal(value: float, *, single: bool) -> str:
    """Return the shortest literal that reads back as exactly this value."""
    return f"{np.float32(value)!s}F" if single else repr(value)


def _rows(table: Iterable[Iterable[float]], *, single: bool) -> Iterator[str]:
    """Return initialisers; whole numbers are exact in any type."""
    for row in table:
        texts = (
            f"{int(value)}U" if value == int(value) else _literal(float(value), single=single)
            for value in row
        )
        yield "    {" + ", ".join(texts) + "},"
