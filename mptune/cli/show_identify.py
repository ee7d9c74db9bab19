"""What ``mptune identify`` prints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.cli.show import console, new_table, verdict
from mptune.identify.result import BANDS, FitStatus
from mptune.units import number

if TYPE_CHECKING:
    from rich.text import Text

    from mptune.identify.result import Agreement, IdentifyResult, Panel


def identified(result: IdentifyResult) -> None:
    """Print each panel's agreement with theory, and its counts."""
    shown = new_table(f"The force loop beside G_F with its delay ({result.excitation.value})")
    shown.add_column("panel", no_wrap=True)
    shown.add_column("band [rad/s]", justify="right")
    for heading in ("limits", "largest median", "largest", "within"):
        shown.add_column(heading, justify="right")
    shown.add_column("verdict")
    for panel in result.panels:
        name = panel.name
        for band in BANDS:
            agreement = panel.agreement(band)
            if agreement is not None:
                shown.add_row(name, *_cells(agreement))
                name = ""
    console.print(shown)
    for panel in result.panels:
        console.print(_counts(panel))


def _cells(agreement: Agreement) -> tuple[str | Text, ...]:
    band = agreement.band
    return (
        f"{band.low:g}–{band.high:g}",
        _pair(band.decibels, band.degrees, "±"),
        _pair(agreement.median_decibels, agreement.median_degrees),
        _pair(agreement.largest_decibels, agreement.largest_degrees),
        f"{100 * agreement.within:.1f} %",
        verdict("agrees" if agreement.satisfied else "DISAGREES", good=agreement.satisfied),
    )


def _pair(decibels: float, degrees: float, sign: str = "") -> str:
    return f"{sign}{number(decibels, 2)} dB, {sign}{number(degrees, 3)}°"


def _counts(panel: Panel) -> str:
    failed = [
        f"{panel.count(status)} {status.name.lower().replace('_', ' ')}"
        for status in FitStatus
        if status is not FitStatus.FITTED and panel.count(status)
    ]
    return (
        f"{panel.name}: {len(panel.velocity)} operating points, {panel.skipped} skipped (p_B above "
        f"p_max), {panel.status.size} fits, {', '.join(failed) or 'all valid'}"
    )
