"""The study's own gains and the tuned ones beside the paper: linear check and nonlinear machine."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.params.paper import (
    MEASURED_FINAL_ERROR,
    MEASURED_FORCE_ERROR,
    MEASURED_INDEX_RANGE,
    MEASURED_LOSS,
)
from mptune.report.blocks import Cell, Tabular, left, right
from mptune.report.content.closed_loop import index_text, milliseconds, of_mass
from mptune.sim.merit import merit
from mptune.verify.before_after import FIGURES, Mark, named

if TYPE_CHECKING:
    from mptune.report.results import Results
    from mptune.verify.before_after import Change
    from mptune.verify.result import VerifyResult

_LOOKS = {Mark.BETTER: "good", Mark.WORSE: "bad"}


def beside_the_paper(results: Results) -> Tabular:
    """Return each figure by mass: the paper's, and what the study's own and these gains give."""
    masses = sorted({case.mass_kg for case in results.moves})
    rows: list[list[str | Cell]] = [["linear-check index [ms]"]]
    for mass in masses:
        rows[0] += [milliseconds(MEASURED_INDEX_RANGE.get(mass)), _linear(results, mass)]
    by_place = {(one.key, one.mass_kg): one for one in results.changes}
    for key in FIGURES if by_place else ():
        row: list[str | Cell] = [heading(key)]
        for mass in masses:
            row += [_paper(key, mass), pair_text(by_place[key, mass])]
        rows.append(row)
    if not all(verified is None or verified.satisfied for verified in _both(results)):
        stable: list[str | Cell] = ["stable runs"]
        for mass in masses:
            stable += ["—", _stable(results, mass)]
        rows.append(stable)
    columns = left("Study's own → these")
    for mass in masses:
        columns += right(f"Paper, {mass / 1e3:g} t", f"{mass / 1e3:g} t")
    beside = ", beside the paper" if MEASURED_LOSS.keys() & set(masses) else ""
    return Tabular(f"Before and after{beside}", columns, rows)


def heading(key: str) -> str:
    """Return a figure's name with its unit, as the first cell of its row."""
    one = merit(key)
    return named(key) if one.unit == "1" else f"{named(key)} [{one.printed_unit}]"


def _linear(results: Results, mass: float) -> str:
    both = (
        index_text([case for case in moves if case.mass_kg == mass])
        for moves in (results.moves_before, results.moves)
    )
    return " → ".join(both)


def pair_text(change: Change) -> str | Cell:
    """Return a figure before and after, and which of them is better."""
    one = merit(change.key)
    text = f"{one.text(change.before)} → {one.text(change.after)}, {change.mark}"
    return Cell(text, _LOOKS[change.mark]) if change.mark in _LOOKS else text


def _both(results: Results) -> tuple[VerifyResult | None, VerifyResult | None]:
    return results.verified_before, results.verified


def _stable(results: Results, mass: float) -> str:
    counts = []
    for verified in _both(results):
        cases = of_mass(verified, mass)
        counts.append(f"{sum(case.stable for case in cases)} of {len(cases)}")
    return " → ".join(counts)


def _paper(key: str, mass: float) -> str:
    """Return what the paper measured, of its own gains; a dash where it does not say."""
    if key == "performance_index_ms":
        return milliseconds(MEASURED_INDEX_RANGE.get(mass))
    if mass not in MEASURED_LOSS:
        return "—"
    if key == "energy_loss_j_per_mm":
        return f"{MEASURED_LOSS[mass]:g}"
    if key == "final_error_mm":
        return f"≤ {MEASURED_FINAL_ERROR:g}"
    heaviest = mass == max(MEASURED_LOSS)
    return f"{MEASURED_FORCE_ERROR:g}" if heaviest and key.startswith("force_error") else "—"
