"""Fig. 3: the simulated force loop beside Eq. 11, where it was identified."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.identify.result import BANDS, FitStatus
from mptune.report.blocks import (
    Chapter,
    Figure,
    Note,
    Prose,
    Row,
    Tabular,
    equations,
    left,
    right,
    verdict,
    wide,
)
from mptune.units import number

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.identify.result import Agreement, Panel
    from mptune.report.results import Results

_SHORT = 24  # rows of a table that is kept on one page


def identification(results: Results) -> Chapter | None:
    """Return Fig. 3's panels and their agreement with theory."""
    panels = results.leftovers.panels
    if not panels:
        return None
    figures = [
        Figure(
            "Simulated responses of the force loop at each operating point, their median, and "
            "Eq. 11 with its delay.",
            name,
        )
        for name in sorted(results.leftovers.figures or ())
        if name.startswith("identification")
    ]
    return Chapter.of(
        "Identification of the force loop",
        Prose("The force controller on the nonlinear machine, excited at Eq. 13's points, beside"),
        equations("eq11"),
        *figures,
        agreement(panels),
        Note(
            "Largest deviation over frequency of the median over the points, and of any point. "
            "Within: share of the fits within the limits."
        ),
        *(Note(counts(panel)) for panel in panels),
    )


def agreement(panels: Sequence[Panel]) -> Tabular:
    """Return each panel's agreement with theory, band by band."""
    rows: list[Row] = [
        [panel.name, *_agreement(found)]
        for panel in panels
        for band in BANDS
        if (found := panel.agreement(band)) is not None
    ]
    columns = [wide("Panel"), *right("Band\n[rad/s]", "Limits", "Largest\nmedian", "Largest")]
    columns += [*right("Within"), *left("Verdict")]
    title = "The force loop beside G_F with its delay"
    return Tabular(title, columns, rows, keep=len(rows) <= _SHORT)


def _agreement(found: Agreement) -> Row:
    band = found.band
    return [
        f"{band.low:g}–{band.high:g}",
        _pair(band.decibels, band.degrees, "±"),
        _pair(found.median_decibels, found.median_degrees),
        _pair(found.largest_decibels, found.largest_degrees),
        f"{100 * found.within:.1f} %",
        verdict("agrees" if found.satisfied else "DISAGREES", good=found.satisfied),
    ]


def _pair(decibels: float, degrees: float, sign: str = "") -> str:
    return f"{sign}{number(decibels, 2)} dB, {sign}{number(degrees, 3)}°"


def counts(panel: Panel) -> str:
    """Return how many points and fits a panel has, and what became of them."""
    failed = [
        f"{panel.count(status)} {status.name.lower().replace('_', ' ')}"
        for status in FitStatus
        if status is not FitStatus.FITTED and panel.count(status)
    ]
    return (
        f"{panel.name}: {len(panel.velocity)} operating points, {panel.skipped} skipped (p_B above "
        f"p_max), {panel.status.size} fits, {', '.join(failed) or 'all valid'}"
    )
