"""The study's parameters with units and sources, and where mptune differs from the paper."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mptune.loops.family import derived_time_constants
from mptune.params.chambers import LETTERS
from mptune.params.lines import instead_of_supplies, nominal_pressures
from mptune.params.paper import LEDGER
from mptune.params.requirements import Requirements
from mptune.params.section import Section
from mptune.report.blocks import (
    Block,
    Cell,
    Chapter,
    Prose,
    Row,
    Tabular,
    left,
    right,
    symbol,
    wide,
)
from mptune.units import number, shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mptune.params.study import ResolvedStudy
    from mptune.report.results import Results


def parameters(results: Results) -> Chapter:
    """Return the study's sections with each parameter's symbol, value, meaning and source."""
    study = results.study
    tau_a, tau_b = (shown(pair, "s", ranged=True) for pair in derived_time_constants(study))
    words = Prose(
        "For this machine Eq. 4 and Eq. 12 give, over the stroke and the oil's range, τ_A = "
        f"{tau_a} and τ_B = {tau_b}. The uncertainty set used is in the table below."
    )
    return Chapter("Parameters and their sources", [words, *_sections(study)])


def _sections(study: ResolvedStudy) -> Iterator[Block]:
    values = study.study.model_copy(update={"uncertainty": study.uncertainty})
    chosen, of_lines = study.uncertainty_name, instead_of_supplies(study.study.lines)
    columns = [wide("Symbol", 1.6), wide("Meaning", 5.2), wide("Value", 3.6), wide("Source", 6.6)]
    for name in type(study.study).model_fields:
        part = getattr(values, name)
        if not isinstance(part, Section) or name not in study.study.model_fields_set:
            continue  # a list, or a section that the study leaves out
        prefix = f"uncertainty.sets.{chosen}" if name == "uncertainty" and chosen else name
        rows: list[Row] = [
            [
                symbol(mark),
                meaning,
                shown(getattr(part, key), unit, ranged=part.is_range(key)),
                Cell(study.study.source_of(f"{prefix}.{key}") or "this study", "small"),
            ]
            for key, unit, mark, meaning in part.quantities()
            if _is_given(getattr(part, key)) and not (name == "supplies" and key in of_lines)
        ]
        if isinstance(part, Requirements):
            rows = [*_ratios(part, study), *rows, *_bounds(part, study)]
        yield from Tabular(name, columns, rows).titled()
    if study.study.lines:
        yield from _lines(study).titled()
    if study.study.chambers:
        yield from _chambers(study).titled()
    yield from _moves(study).titled()


def _ratios(asked: Requirements, study: ResolvedStudy) -> Iterator[Row]:
    """Yield the largest allowed ratios, which are numbers or curves over frequency."""
    for key, equation in (("velocity_ratio", "Eq. 17"), ("position_ratio", "Eq. 21")):
        ratio = getattr(asked, key)
        values = ((None, ratio),) if isinstance(ratio, float) else ratio
        text = ", ".join(
            number(value) if at is None else f"{number(value)} at {number(at)} rad/s"
            for at, value in values
        )
        source = study.study.source_of(f"requirements.{key}") or "this study"
        yield ["", f"largest left/right ratio of {equation}", text, Cell(source, "small")]


def _bounds(asked: Requirements, study: ResolvedStudy) -> Iterator[Row]:
    """Yield the bounds of single gains."""
    for key, unit, mark, meaning in asked.bounds.quantities():
        pair = getattr(asked.bounds, key)
        if pair is not None:
            source = study.study.source_of(f"requirements.bounds.{key}") or "this study"
            text = shown(pair, unit, ranged=True)
            yield [symbol(mark), meaning, text, Cell(source, "small")]


def _lines(study: ResolvedStudy) -> Tabular:
    """Return the lines, the lowest pressure first."""
    lines, rule = study.study.lines, study.study.edge_rule
    rows: list[Row] = [
        [
            str(count),
            one.kind.value,
            shown(pressure, "Pa"),
            "—" if one.between is None else f"{one.between[0]} and {one.between[1]}",
            "—" if one.share is None else number(one.share),
            ", ".join(map(number, sizes)),
        ]
        for count, (one, pressure, sizes) in enumerate(
            zip(lines, nominal_pressures(lines), rule.sizes, strict=True), 1
        )
    ]
    columns = left("Line", "Kind") + right(
        "Pressure", "Made between", "Share of the upper", "Valves' sizes"
    )
    return Tabular("lines", columns, rows, legend=study.study.source_of("lines"))


def _chambers(study: ResolvedStudy) -> Tabular:
    """Return the chambers, one by one."""
    rows: list[Row] = [
        [
            letter,
            one.side.value,
            shown(one.area, "m^2"),
            shown(one.dead_volume, "m^3"),
            shown(one.hose_length, "m"),
            number(one.valves),
        ]
        for letter, one in zip(LETTERS, study.study.chambers, strict=False)
    ]
    columns = left("Chamber", "Side") + right(
        "Area", "Dead volume", "Hose", "Valves, in those of the edges"
    )
    return Tabular("chambers", columns, rows, legend=study.study.source_of("chambers"))


def _moves(study: ResolvedStudy) -> Tabular:
    """Return the movement set, move by move."""
    rows: list[Row] = [
        [
            str(count),
            move.kind,
            shown(move.net_distance, "m"),
            f"{move.duration:g} s",
            f"{move.rest:g} s",
            shown(move.peak_velocity, "m/s"),
        ]
        for count, move in enumerate(study.study.manoeuvre, 1)
    ]
    columns = [*left("Move", "Shape"), *right("Distance", "Time", "Rest", "Peak velocity")]
    legend = study.study.source_of("manoeuvre.distance")
    return Tabular("manoeuvre", columns, rows, legend=legend)


def _is_given(value: object) -> bool:
    """Return whether a value says something: supplies have none of what no line needs."""
    return value is not None and not (isinstance(value, float) and not math.isfinite(value))


def ledger(_results: Results | None = None) -> Chapter:
    """Return the ledger of disagreements with the paper."""
    rows: list[Row] = [
        [Cell(text, "small") for text in (entry.where, entry.reads, entry.used, entry.why)]
        for entry in LEDGER
    ]
    columns = [wide("Where", 2.2), wide("The paper reads", 3.2), wide("Used here", 4)]
    columns.append(wide("Why", 7.6))
    table = Tabular("Where mptune differs from the paper", columns, rows, keep=False)
    return Chapter(table.title, [table])
