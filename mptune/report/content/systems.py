"""The systems that §7 compares with, under the study's own load and moves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mptune.params.paper import MEASURED_INDEX_RANGE, MEASURED_LOSS, OTHER_SYSTEMS
from mptune.report.blocks import (
    Block,
    Cell,
    Chapter,
    Figure,
    Note,
    Prose,
    Row,
    Tabular,
    left,
    right,
    symbol,
    wide,
)
from mptune.sim.merit import merit
from mptune.units import number, shown

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mptune.report.results import Results

RULE = (
    "The index measures the controller more than the actuator: every system is shown under its "
    "literature's controller and, where one is better, under the best by one rule, the least worst "
    "index of those that stay stable on every mass with the loop's gain raised by the same factor."
)
_INDEX, _LOSS = merit("performance_index_ms"), merit("energy_loss_j_per_mm")
_FORCE = merit("force_error_integral_kn2s")


def systems(results: Results) -> Chapter | None:
    """Return the comparison, where it was made."""
    rows = results.leftovers.systems
    if not rows:
        return None
    return Chapter.of(
        "Other systems under the same load",
        Figure(
            "Loss over index: filled by its literature's controller or a study's own gains, open "
            "by the best one under the common rule; dotted, the losses that §7 tells.",
            "systems",
        ),
        Prose(RULE),
        compared(rows).brief(),
        *boundaries(rows).titled(),
        *calibrated(rows).titled(
            Note(
                "What was calibrated was chosen so that a figure of the paper comes out: that "
                "figure is no prediction. Runs on the largest mass, literature's controller."
            )
        ),
        *_parameters(results),
    )


def compared(rows: Sequence[dict[str, Any]]) -> Tabular:
    """Return the table of all runs, beside what §7 tells."""
    body: list[Row] = []
    for run in (one for one in rows if one["kind"] == "run"):
        index, loss = _told(run["system"], run["mass_kg"])
        body.append(
            [
                run["title"],
                run["controller"] + (", best" if run["best"] else ""),
                f"{run['mass_kg'] / 1e3:g}",
                _text(run[_INDEX.key]) if run["stable"] else Cell("not stable", "bad"),
                _text(run["reference_index_ms"]),
                index,
                _text(run[_LOSS.key]),
                loss,
                _text(run["returned_j_per_mm"]),
                _text(run[_FORCE.key]),
                _text(run["valve_switches"]),
                _residual(run["energy_residual"]),
            ]
        )
    columns = [
        wide("System", 3),
        wide("Controller", 2),
        *right("Mass\n[t]", "Index\n[ms]", "over v_ref\n[ms]", "paper\n[ms]"),
        *right("Loss\n[J/mm]", "paper\n[J/mm]"),
        *right("returned\n[J/mm]", detail=True),
        *right("∫ΔF²\n[kN² s]", "Switches"),
        *right("Residual", detail=True),
    ]
    return Tabular("Systems under the same load and moves", columns, body, keep=False)


def _told(system: str, mass: float) -> tuple[str, str]:
    """Return what §7 tells of a system's index [ms] and loss [J/mm] on a mass [kg]."""
    if mass not in MEASURED_LOSS:  # another machine's
        return "–", "–"
    for one in OTHER_SYSTEMS:
        if one.key == system and one.mass in {None, mass}:
            return one.index, number(one.loss, 3)
    if system != "this_machine":
        return "–", "–"
    least, largest = MEASURED_INDEX_RANGE[mass]
    return f"{number(1e3 * least, 2)}–{number(1e3 * largest, 2)}", number(MEASURED_LOSS[mass], 3)


def boundaries(rows: Sequence[dict[str, Any]]) -> Tabular:
    """Return the controllers in words, and where the boundary of each loss lies."""
    body: dict[tuple[str, str], Row] = {}
    for run in (one for one in rows if one["kind"] == "run"):
        texts = (run["title"], run["controller"], run["gains"], run["boundary"])
        body[texts[:2]] = [Cell(text, "small") for text in texts]
    columns = [wide("System", 3), *left("Controller"), wide("Gains", 4), wide("Drawn power", 4)]
    return Tabular("Controllers, and the boundary of the loss", columns, list(body.values()))


def calibrated(rows: Sequence[dict[str, Any]]) -> Tabular:
    """Return what was calibrated, and how far loss and index move with it."""
    body: list[Row] = [
        [
            Cell(one["key"].removeprefix("systems."), "key"),
            shown(one["value"], one["unit"]),
            f"±{100 * one['change']:g} %",
            " / ".join(_text(value) for value in one[_LOSS.key]),
            " / ".join(_text(value) for value in one[_INDEX.key]),
            Cell(one["source"], "small"),
        ]
        for one in rows
        if one["kind"] == "calibrated"
    ]
    columns = [*left("Key"), *right("Value", "Change", "Loss [J/mm]", "Index [ms]")]
    return Tabular("Calibrated values", [*columns, wide("Source", 4)], body, keep=False)


def _parameters(results: Results) -> Iterator[Block]:
    """Yield each system's parameters with the word of their source."""
    asked = results.study.study.systems
    columns = [wide("Symbol", 1.6), wide("Meaning", 5.2), wide("Value", 3.6), wide("Source", 6.6)]
    for name, part in asked.parts().items():
        body: list[Row] = [
            [
                symbol(mark),
                meaning,
                shown(getattr(part, key), unit, ranged=part.is_range(key)),
                Cell(results.study.study.source_of(f"systems.{name}.{key}"), "small"),
            ]
            for key, unit, mark, meaning in part.quantities()
        ]
        yield from Tabular(f"systems.{name}", columns, body).titled()


def _residual(value: float | None) -> str:
    return "–" if value is None else f"{value:.0e}"


def _text(value: float | None) -> str:
    return "–" if value is None else number(value, 3)
