"""Fig. 3: the simulated force loop beside Eq. 11, where it was identified."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mptune.identify.result import BANDS
from mptune.report.blocks import (
    Cell,
    equations,
    figure,
    left,
    note,
    prose,
    right,
    section,
    table,
    verdict,
    wide,
)

if TYPE_CHECKING:
    from mptune.identify.result import Band, Panel
    from mptune.report.results import Results

_SHORT = 24  # rows of a table that is kept on one page


def identification(results: Results) -> dict[str, Any] | None:
    """Return Fig. 3's panels and their agreement with theory."""
    panels = results.leftovers.panels
    if not panels:
        return None
    figures = [
        figure(
            name,
            "Simulated responses of the force loop at each operating point, their median, and "
            "Eq. 11 with its delay.",
        )
        for name in sorted(results.leftovers.figures or ())
        if name.startswith("identification")
    ]
    columns = [wide("Panel"), *right("Band [rad/s]", "Median, off by [dB]", "[°]", "Within")]
    rows = [_agreement(panel, band) for panel in panels for band in BANDS]
    limits = "; ".join(
        f"±{band.decibels:g} dB and ±{band.degrees:g}° up to {band.high:g} rad/s" for band in BANDS
    )
    return section(
        "Identification of the force loop",
        prose("The force controller on the nonlinear machine, excited at Eq. 13's points, beside"),
        equations("eq11"),
        *figures,
        table([*columns, *left("Verdict")], [row for row in rows if row], keep=len(rows) <= _SHORT),
        note(
            "Median: largest deviation over frequency of the median over the points. Within: share "
            f"of the fits within {limits}."
        ),
    )


def _agreement(panel: Panel, band: Band) -> list[str | Cell]:
    found = panel.agreement(band)
    if found is None:
        return []
    return [
        panel.name,
        f"{band.low:g}–{band.high:g}",
        f"{found.median_decibels:+.2f}",
        f"{found.median_degrees:+.1f}",
        f"{100 * found.within:.0f} %",
        verdict("agrees" if found.satisfied else "differs", good=found.satisfied),
    ]
