"""What ``mptune identify`` prints, of the simulated force loop and of measured data."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.cli.terminal import say, show, verbatim
from mptune.identify.ranges import spread_in_words
from mptune.report.blocks import Row, Tabular, left, right, verdict
from mptune.report.content.identification import agreement, counts
from mptune.units import number

if TYPE_CHECKING:
    from mptune.identify.fitted import Interval
    from mptune.identify.result import IdentifyResult
    from mptune.job.measured import MeasuredResult


def identified(result: IdentifyResult) -> None:
    """Print each panel's agreement with theory, and its counts."""
    say(f"Excited by: {result.excitation.value}")
    show(agreement(result.panels))
    for panel in result.panels:
        say(counts(panel))


def measured(result: MeasuredResult) -> None:
    """Print what was fitted to each response, and the ranges over all of them."""
    rows: list[Row] = [
        [
            one.name,
            *(_interval(each) for each in (one.tau_a, one.tau_b, one.delay)),
            f"{100 * one.error:.2g} %",
            one.weakest,
            verdict(one.certainty.value, good=one.good),
        ]
        for one in result.fits
    ]
    columns = [*left("Response"), *right("τ_A [ms]", "τ_B [ms]", "Delay [ms]", "Error")]
    columns += left("Least known", "Verdict")
    show(Tabular("Eq. 11 with a dead time, fitted (95 % confidence)", columns, rows))
    say(spread_in_words(result.fits))
    say("For the study, in the place of its own [uncertainty]:")
    verbatim(result.section)


def _interval(one: Interval) -> str:
    low, value, high = (number(1e3 * end, 4) for end in (one.low, one.value, one.high))
    return f"{value} ({low}–{high})"
