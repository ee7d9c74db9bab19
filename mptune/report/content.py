"""What the report says, as plain data: texts and numbers, never markup."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mptune.loops.family import derived_time_constants
from mptune.params.gains import now, version
from mptune.params.paper import (
    LEDGER,
    MEASURED_FINAL_ERROR,
    MEASURED_FORCE_ERROR,
    MEASURED_INDEX_RANGE,
    MEASURED_LOSS,
)
from mptune.params.section import Section
from mptune.robust.chain import factor_text
from mptune.robust.result import Check, Status
from mptune.robust.tables import EQUATIONS, margin_rows, place_text, undecided_text
from mptune.units import number, shown

if TYPE_CHECKING:
    from mptune.params.study import ResolvedStudy
    from mptune.robust.chain import Link
    from mptune.robust.result import SweepResult
    from mptune.sim.sampled import LinearMove
    from mptune.tune.result import TuneResult
    from mptune.verify.result import CaseResult, VerifyResult


@dataclass(frozen=True)
class Results:
    """What a run has produced; the report shows what is there."""

    study: ResolvedStudy
    sweep: SweepResult
    published: SweepResult
    tuned: TuneResult | None
    moves: tuple[LinearMove, ...]
    moves_before: tuple[LinearMove, ...]
    verified: VerifyResult | None
    chain: tuple[Link, ...]
    satisfied: bool


def content(results: Results) -> dict[str, Any]:
    """Return everything that the template prints."""
    study = results.study
    return {
        "title": study.title,
        "study": study.name,
        "uncertainty": study.uncertainty_name or "default",
        "version": version(),
        "hash": study.hash(),
        "date": now(),
        "satisfied": results.satisfied,
        "path": study.study.model.measurement_path,
        "status": _status(results),
        "warnings": _warnings(results),
        "gains": _gains(results),
        "checks": [_check(check) for check in results.sweep.checks],
        "conditions": _conditions(results),
        "margins": [
            {"label": label, "cells": cells} for label, cells in margin_rows(results.sweep)
        ],
        "chain": [
            {"model": link.name, "factor": factor_text(link.factor), "at": place_text(link.at)}
            for link in results.chain
        ],
        "closed_loop": _closed_loop(results),
        "verified": _verified(results.verified),
        "comparison": _comparison(results.verified),
        "parameters": _parameters(study),
        "derived": [shown(pair, "s", ranged=True) for pair in derived_time_constants(study)],
        "ledger": [
            {"where": entry.where, "reads": entry.reads, "used": entry.used, "why": entry.why}
            for entry in LEDGER
        ],
    }


def _status(results: Results) -> str:
    if results.tuned is None:
        return "The study's own gains were swept; nothing was tuned."
    before, after = results.tuned.figures_before.tracking, results.tuned.figures.tracking
    text = (
        f"Tuning: {results.tuned.status.value}. Worst linear tracking index "
        f"{1e3 * before:.1f} ms with the study's gains, {1e3 * after:.1f} ms tuned."
    )
    blocking = results.tuned.blocking
    if blocking is not None:
        text += (
            f" Blocked by {blocking.requirement} at {place_text(blocking.at)}: {blocking.remedy}."
        )
    return text


def _warnings(results: Results) -> list[str]:
    undecided = undecided_text(results.sweep)
    found = [undecided] if undecided else []
    for family in results.sweep.families:
        if family.unstable_count:
            path = "with" if family.path == "filters" else "without"
            found.append(
                f"{family.unstable_count} of {len(family.stable)} plants are unstable {path} the "
                f"measurement path, for instance {place_text(family.first_unstable())}. "
                + (
                    "Eq. 17 and Eq. 21 as stated leave that path out."
                    if family.path == "filters"
                    and results.study.study.model.measurement_path == "none"
                    else ""
                )
            )
    found += [
        f"{check.name} {check.limit}: cannot be evaluated, as some total delay is below half a "
        "sampling period."
        for check in results.sweep.checks
        if check.status is Status.NOT_EVALUATED
    ]
    return [text.strip() for text in found]


def _gains(results: Results) -> list[dict[str, str]]:
    rows = []
    for key, unit, symbol, meaning in results.sweep.gains.quantities():
        rows.append(
            {
                "symbol": symbol,
                "key": key,
                "value": shown(getattr(results.sweep.gains, key), unit),
                "before": shown(getattr(results.published.gains, key), unit),
                "meaning": meaning,
            }
        )
    return rows


def _check(check: Check) -> dict[str, Any]:
    return {
        "name": check.name,
        "limit": check.limit,
        "found": number(check.found),
        "status": check.status.value,
        "met": check.status is Status.SATISFIED,
        "at": place_text(check.at),
    }


def _conditions(results: Results) -> list[dict[str, Any]]:
    swept = {"study's": results.published, "tuned": results.sweep}
    if results.tuned is None:
        del swept["tuned"]
    return [
        {
            "gains": label,
            "equation": EQUATIONS[condition.name],
            "ratio": f"{condition.worst_ratio:.4f}",
            "margin": f"{condition.margin:.3f}",
            "at": place_text(condition.at),
            "limit": condition.low_frequency_limit,
            "nominal_stable": condition.nominal_stable,
            "poles_equal": condition.poles_equal,
            "status": condition.status.value,
        }
        for label, sweep in swept.items()
        for condition in sweep.conditions
    ]


def _closed_loop(results: Results) -> list[dict[str, str]]:
    rows = []
    for case, before in zip(results.moves, results.moves_before, strict=True):
        measured = MEASURED_INDEX_RANGE.get(case.mass_kg)
        rows.append(
            {
                "mass": f"{case.mass_kg / 1e3:g} t",
                "delay": f"{1e3 * case.valve_delay_s:g} ms",
                "before": _index(before),
                "after": _index(case),
                "paper": f"{1e3 * measured[0]:.1f}–{1e3 * measured[1]:.1f} ms" if measured else "—",
            }
        )
    return rows


def _index(case: LinearMove) -> str:
    return f"{case.performance_index_ms:.1f} ms" if case.stable else "unstable"


def _verified(verified: VerifyResult | None) -> list[dict[str, Any]]:
    """Return one row per verified machine."""
    return [
        {
            "mass": f"{case.mass_kg / 1e3:g} t",
            "oil": f"{case.oil_bulk_modulus_pa / 1e6:g} MPa",
            "seed": str(case.seed),
            "index": number(case.mean("performance_index_ms"), 3),
            "loss": number(case.mean("energy_loss_j_per_mm"), 3),
            "force": number(case.mean("force_error_integral_kn2s"), 3),
            "final": number(case.span("final_error_mm")[1], 2),
            "converter": number(case.span("converter_peak_mm")[1], 3),
            "switches": number(case.mean("valve_switches"), 4),
            "status": case.status.value + (f", {case.broken}" if case.broken else ""),
            "stable": case.stable,
        }
        for case in (verified.cases if verified else ())
    ]


def _comparison(verified: VerifyResult | None) -> list[dict[str, str]]:
    """Return §7's figures, by mass: the paper's, here, and whether predicted or calibrated."""
    rows: list[dict[str, str]] = []
    for mass in sorted({case.mass_kg for case in verified.cases} if verified else ()):
        cases = [case for case in (verified.cases if verified else ()) if case.mass_kg == mass]
        index, loss = MEASURED_INDEX_RANGE.get(mass), MEASURED_LOSS.get(mass)
        losses = f"{loss:g}" if loss else "—"
        force = f"{MEASURED_FORCE_ERROR:g}" if mass == max(MEASURED_LOSS) else "—"
        final = f"≤ {MEASURED_FINAL_ERROR:g}" if index else "—"
        indices = _span(cases, "performance_index_ms", 1)
        finals = _span(cases, "final_error_mm", 2)
        by_pump = _means(cases, "pump_loss_j_per_mm")
        energy, squares = _means(cases, "energy_loss_j_per_mm"), "force_error_integral_kn2s"
        for figure, paper, here, kind in (
            ("performance index [ms]", _times(index), indices, "predicted"),
            ("energy loss, mean [J/mm]", losses, energy, "calibrated"),
            ("… by pump power, as §7.1 [J/mm]", losses, by_pump, "calibrated"),
            ("∫ force error² [kN² s]", force, _means(cases, squares), "calibrated"),
            ("final error [mm]", final, finals, "predicted"),
        ):
            row = {"mass": f"{mass / 1e3:g} t", "figure": figure, "paper": paper}
            rows.append({**row, "here": here, "kind": kind})
    return rows


def _times(pair: tuple[float, float] | None) -> str:
    return f"{1e3 * pair[0]:.1f}–{1e3 * pair[1]:.1f}" if pair else "—"


def _span(cases: list[CaseResult], figure: str, digits: int) -> str:
    low = min(case.span(figure)[0] for case in cases)
    high = max(case.span(figure)[1] for case in cases)
    return f"{low:.{digits}f}–{high:.{digits}f}"


def _means(cases: list[CaseResult], figure: str) -> str:
    means = [case.mean(figure) for case in cases]
    return f"{min(means):.1f}–{max(means):.1f}"


def _parameters(study: ResolvedStudy) -> list[dict[str, Any]]:
    """Return the study's sections with each parameter's symbol, value, meaning and source."""
    sections = []
    values = study.study.model_copy(update={"uncertainty": study.uncertainty})
    for name in type(study.study).model_fields:
        section = getattr(values, name)
        if not isinstance(section, Section):
            continue
        source = f"uncertainty.sets.{study.uncertainty_name}"
        prefix = source if name == "uncertainty" and study.uncertainty_name else name
        rows = [
            {
                "symbol": symbol,
                "key": key,
                "value": shown(getattr(section, key), unit, ranged=section.is_range(key)),
                "meaning": meaning,
                "source": study.study.source_of(f"{prefix}.{key}") or "this study",
            }
            for key, unit, symbol, meaning in section.quantities()
            if getattr(section, key) is not None
        ]
        if rows:
            sections.append({"name": name, "rows": rows})
    return sections
