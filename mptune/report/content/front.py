"""The verdict page: verdict, what to mind, gains, requirements, and beside what they stand."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mptune.params.paper import MEASURED_INDEX_RANGE, MEASURED_LOSS
from mptune.report.blocks import (
    Block,
    Cell,
    Column,
    heading,
    left,
    right,
    symbol,
    table,
    verdict,
    wide,
)
from mptune.report.content.closed_loop import index_text, milliseconds, of_mass
from mptune.robust.result import Status
from mptune.robust.tables import place_text, undecided_text
from mptune.sim.merit import merit
from mptune.tune.baselines import LABELS
from mptune.units import number, shown

if TYPE_CHECKING:
    from mptune.params.section import Section
    from mptune.report.results import Results
    from mptune.robust.result import Check

_INDEX, _LOSS = merit("performance_index_ms"), merit("energy_loss_j_per_mm")


def front_page(results: Results) -> dict[str, Any]:
    """Return the verdict with its reasons, and the tables of the first page."""
    study = results.study
    met = results.satisfied
    return {
        "about": f"Study {study.name}, uncertainty set {study.uncertainty_name or 'default'}, "
        f"measurement path in the model: {study.study.model.measurement_path}",
        "headline": "Every requirement is met" if met else "Some requirement is not met",
        "status": _status(results),
        "warnings": _warnings(results),
        "blocks": [
            *_gains(results),
            *_requirements(results),
            *_paper(results),
            *_baselines(results),
        ],
    }


def _status(results: Results) -> list[str]:
    tuned = results.tuned
    if tuned is None:
        return ["The study's own gains were swept; nothing was tuned."]
    before, after = tuned.figures_before.tracking, tuned.figures.tracking
    words = (
        f"Tuning: {tuned.status.value}. Worst linear tracking index {1e3 * before:.1f} ms with "
        f"the study's gains, {1e3 * after:.1f} ms tuned."
    )
    texts = [words]
    if tuned.binding:
        texts.append(f"The gains lie at: {', '.join(tuned.binding)}.")
    blocking = tuned.blocking
    if blocking is not None:
        texts.append(
            f"Blocked by {blocking.requirement} at {place_text(blocking.at)}: {blocking.remedy}."
        )
        texts += [
            f"With all else kept, {relief.requirement} would have to give by a factor "
            f"{number(relief.factor)}."
            for relief in blocking.reliefs
        ]
    return texts


def _warnings(results: Results) -> list[str]:
    undecided = undecided_text(results.sweep)
    found = [undecided] if undecided else []
    for family in results.sweep.families:
        if not family.unstable_count:
            continue
        filtered = family.path == "filters"
        found.append(
            f"{family.unstable_count} of {len(family.stable)} plants are unstable "
            f"{'with' if filtered else 'without'} the measurement path, for instance "
            f"{place_text(family.first_unstable())}."
        )
        if filtered and results.study.study.model.measurement_path == "none":
            found[-1] += " Eq. 17 and Eq. 21 as stated leave that path out."
    found += [
        f"{check.label} {check.limit}: cannot be evaluated, as some total delay is below half a "
        "sampling period."
        for check in results.sweep.checks
        if check.status is Status.NOT_EVALUATED
    ]
    return found


def _gains(results: Results) -> list[Block]:
    sets: list[tuple[Section, Section]] = [(results.sweep.gains, results.published.gains)]
    ahead, own = results.feedforward, results.study.study.feedforward
    if ahead != type(ahead)() or own != ahead:
        sets.append((ahead, own))  # only where it is used: all off in the paper's own study
    rows: list[list[str | Cell]] = [
        [
            symbol(mark),
            Cell(key, "key"),
            Cell(shown(getattr(found, key), unit), "strong"),
            shown(getattr(before, key), unit),
            meaning,
        ]
        for found, before in sets
        for key, unit, mark, meaning in found.quantities()
    ]
    columns = [*left("Symbol", "Key"), *right("Value", "Study's own"), wide("Meaning")]
    return [heading("Gains"), table(columns, rows, keep=True)]


def _requirements(results: Results) -> list[Block]:
    columns = [*left("Requirement", "Limit"), *right("Found"), *left("Verdict"), wide("Where")]
    rows = [_requirement(check) for check in results.sweep.checks]
    return [heading("Requirements"), table(columns, rows, keep=True)] if rows else []


def _requirement(check: Check) -> list[str | Cell]:
    return [
        check.label,
        check.limit,
        number(check.found),
        verdict(check.status.value, good=check.status is Status.SATISFIED),
        Cell(place_text(check.at), "small"),
    ]


def _paper(results: Results) -> list[Block]:
    """Return index and loss beside the paper's, by mass."""
    rows: list[list[str | Cell]] = []
    for mass in sorted({case.mass_kg for case in results.moves}):
        pairs = [
            (before, after)
            for before, after in zip(results.moves_before, results.moves, strict=True)
            if after.mass_kg == mass
        ]
        cases = of_mass(results.verified, mass)
        rows.append(
            [
                f"{mass / 1e3:g} t",
                milliseconds(MEASURED_INDEX_RANGE.get(mass)),
                index_text([before for before, _ in pairs]),
                index_text([after for _, after in pairs]),
                Cell(_INDEX.text(max(c.figure(_INDEX.key) for c in cases)), "strong")
                if cases
                else "—",
                f"{MEASURED_LOSS[mass]:g}" if mass in MEASURED_LOSS else "—",
                Cell(_LOSS.text(max(c.figure(_LOSS.key) for c in cases)), "strong")
                if cases
                else "—",
            ]
        )
    columns: list[Column] = right(
        "Mass",
        f"{_INDEX.title()}\npaper",
        "linear,\nown gains",
        "linear,\nthese gains",
        "machine,\nthese gains",
        f"{_LOSS.title()}\npaper",
        "machine,\nthese gains",
    )
    return [heading("Beside the paper"), table(columns, rows, keep=True)] if rows else []


def _baselines(results: Results) -> list[Block]:
    """Return the tracking index of simpler controllers, where they were tuned."""
    rows: list[list[str | Cell]] = [
        [
            LABELS[one["structure"]],
            f"{1e3 * one['figures']['tracking_index_s']:.1f}",
            verdict(one["status"] or "not tuned", good=one["satisfied"]),
        ]
        for one in results.leftovers.compared
    ]
    columns = [*left("Controller"), *right("Tracking index [ms]"), *left("Status")]
    words = "Beside simpler controllers under the same requirements"
    return [heading(words), table(columns, rows, keep=True)] if rows else []
