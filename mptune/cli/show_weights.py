"""What ``mptune weights`` prints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.cli.show import console, new_table, verdict
from mptune.sim.merit import merit
from mptune.units import number
from mptune.weigh.trial import OBJECTIVES

if TYPE_CHECKING:
    from rich.table import Table

    from mptune.weigh.result import WeightsResult
    from mptune.weigh.trial import Trial

_FIGURES = tuple(merit(key) for key in (*OBJECTIVES, "converter_peak_mm"))
_HEADINGS = (
    *("W_sw\n[N]", "W_loss\n[N/J]", "W_conv\n[N s/m⁶]", "T_S\n[ms]"),
    *(one.heading("\n") for one in _FIGURES),
)


def weights(result: WeightsResult) -> None:
    """Print the paper's order, the front and the recommendation."""
    table = _table("§5.4's order: W_conv, then W_loss, then W_sw")
    for step in result.steps:
        kept = verdict("kept" if step.kept else "not kept", good=step.kept)
        table.add_row(step.weight, *_cells(step.trial), kept)
    console.print(table)
    usable = sum(result.limits.keeps(trial) for trial in result.trials)
    table = _table(f"Pareto front of {len(result.trials)} trials, {usable} of them usable")
    for place in result.front:
        trial = result.trials[place]
        table.add_row(f"trial {place}", *_cells(trial), "the study's own" if place == 0 else "")
    console.print(table)
    found = result.recommendation
    table = _table("Again, with random numbers that the search has not seen")
    table.add_row("study's own", *_cells(found.own), "")
    table.add_row("recommended", *_cells(found.trial), "")
    table.add_row("spread", *[""] * 4, *(number(one, 2) for one in found.spreads), "", "")
    console.print(table)
    word = "dominate the study's own" if found.dominates else "do not dominate the study's own"
    console.print("The recommended weights", verdict(word, good=found.dominates), "-")
    console.print(f"{found.reason}.")


def _table(title: str) -> Table:
    table = new_table(title)
    table.add_column("", no_wrap=True)
    for heading in _HEADINGS:
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("", no_wrap=True)
    return table


def _cells(trial: Trial) -> tuple[str, ...]:
    tried = trial.weights
    return (
        number(tried.weight_switching, 3),
        number(tried.weight_loss, 3),
        number(tried.weight_converter, 2),
        number(1e3 * tried.sampling_period, 3),
        *(number(trial.mean(figure), 3) for figure in OBJECTIVES),
        number(1e3 * trial.converter_peak, 3),
    )
