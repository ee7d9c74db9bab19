"""What ``mptune identify`` prints of measured data."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.cli.show import console, new_table, verdict
from mptune.identify.fitted import Certainty
from mptune.units import number

if TYPE_CHECKING:
    from mptune.identify.fitted import Interval
    from mptune.job.measured import MeasuredResult


def measured(result: MeasuredResult) -> None:
    """Print what was fitted to each response, and the ranges over all of them."""
    table = new_table("Eq. 11 with a dead time, fitted (95 % confidence)")
    table.add_column("response", no_wrap=True)
    for heading in ("τ_A [ms]", "τ_B [ms]", "delay [ms]", "error"):
        table.add_column(heading, justify="right")
    table.add_column("least known")
    table.add_column("verdict")
    for one in result.fits:
        known = one.certainty is Certainty.DETERMINED
        table.add_row(
            one.name,
            *(_interval(each) for each in (one.tau_a, one.tau_b, one.delay)),
            f"{100 * one.error:.2g} %",
            one.weakest,
            verdict(one.certainty.value, good=known),
        )
    console.print(table)
    console.print("For the study, in the place of its own [uncertainty]:")
    console.print(result.section)


def _interval(one: Interval) -> str:
    low, value, high = (number(1e3 * end, 4) for end in (one.low, one.value, one.high))
    return f"{value} ({low}–{high})"
