"""What the commands print: tables for people on stdout, progress on stderr, or JSON."""

from __future__ import annotations

import json
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from rich import box
from rich.console import Console
from rich.progress import BarColumn, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bars
from rich.table import Table
from rich.text import Text

from mptune.cli.interrupt import interruptible
from mptune.params.paper import LEDGER
from mptune.robust.result import Status
from mptune.robust.tables import EQUATIONS, margin_rows, place_text, undecided_text
from mptune.sim.merit import TABULATED
from mptune.strict import strict
from mptune.units import number, shown

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from mptune.params.section import Section
    from mptune.progress import Progress
    from mptune.robust.result import Check, SweepResult
    from mptune.verify.result import VerifyResult

_PIPE_WIDTH = 120  # columns, where the output is no terminal
console = Console(
    width=None if sys.stdout.isatty() else _PIPE_WIDTH, markup=False, emoji=False, highlight=False
)


def as_json(values: dict[str, Any]) -> None:
    """Print one JSON object; what JSON cannot say (NaN, infinity) becomes null."""
    console.file.write(json.dumps(strict(values), allow_nan=False) + "\n")


@contextmanager
def progress(*, quiet: bool) -> Iterator[Progress]:
    """Yield a function that takes a stage's name and the share of it that is done."""
    errors = Console(stderr=True)
    columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    bars = Bars(*columns, console=errors, transient=True, disable=quiet)
    with interruptible() as check, bars:
        tasks: dict[str, Any] = {}

        def report(stage: str, share: float) -> None:
            check()
            for known, task in tasks.items():
                if known != stage:
                    bars.update(task, total=1.0, completed=1.0)
            if stage not in tasks:
                tasks[stage] = bars.add_task(stage, total=None)
            if share > 0:
                bars.update(tasks[stage], total=1.0, completed=share)

        yield report


def new_table(title: str) -> Table:
    """Return an empty table in the look of all."""
    return Table(title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD)


def verdict(text: str, *, good: bool) -> Text:
    """Return a word, green where it is good and red where not."""
    return Text(text, style="green" if good else "bold red")


def sweep(result: SweepResult) -> None:
    """Print both conditions, the family's margins and the requirements."""
    table = new_table("Robust stability over the family")
    for heading in ("condition", "left/right", "margin", "worst at", "premises", "verdict"):
        table.add_column(heading)
    for condition in result.conditions:
        place = "limit of vanishing frequency" if condition.low_frequency_limit else None
        premises = condition.nominal_stable and condition.poles_equal
        table.add_row(
            f"{EQUATIONS[condition.name]} ({condition.name})",
            f"{condition.worst_ratio:.4f}",
            f"{condition.margin:.3f}",
            place or place_text(condition.at),
            verdict("hold" if premises else "FAIL", good=premises),
            verdict(condition.status.value, good=condition.satisfied),
        )
    console.print(table)
    _margins(result)
    requirements(result.checks)
    undecided = undecided_text(result)
    if undecided:
        console.print(verdict(undecided, good=False))


def _margins(result: SweepResult) -> None:
    table, sampled = new_table("Worst margins of the true family"), result.sampled
    table.add_column("margin")
    for loop in ("velocity", "position", "at F_ref"):
        for path in ("no path", "with path"):
            table.add_column(f"{loop}\n{path}", justify="right")
    table.add_column("at F_ref\nsampled", justify="right")
    for label, cells in margin_rows(result):
        table.add_row(label, *cells)
    table.add_row(
        "unstable plants",
        *(
            verdict(str(count), good=count == 0)
            for loop in range(3)
            for family in result.families
            for count in [int((~(family.stable if loop else family.velocity_stable)).sum())]
        ),
        verdict(str(sampled.unstable_count), good=sampled.unstable_count == 0) if sampled else "—",
    )
    console.print(table)


def requirements(checks: Iterable[Check]) -> None:
    """Print requirements with what was found."""
    table = new_table("Requirements")
    for heading in ("requirement", "limit", "found", "verdict", "where"):
        table.add_column(heading)
    for check in checks:
        good = check.status is Status.SATISFIED
        table.add_row(
            check.label,
            check.limit,
            number(check.found),
            verdict(check.status.value, good=good),
            place_text(check.at),
        )
    console.print(table)


def gains(
    found: Section, before: Section, before_name: str = "study's own", title: str = "Gains"
) -> None:
    """Print gains beside others."""
    table = new_table(title)
    for heading in ("key", "symbol"):
        table.add_column(heading)
    for heading in ("value", before_name):
        table.add_column(heading, justify="right")
    for key, unit, symbol, _ in found.quantities():
        values = (shown(getattr(one, key), unit) for one in (found, before))
        table.add_row(key, symbol, *values)
    console.print(table)


def verified(result: VerifyResult) -> None:
    """Print each machine's figures and status."""
    table = new_table("The nonlinear machine")
    for heading in ("mass", "oil", "seed", *(one.heading() for one in TABULATED)):
        table.add_column(heading, justify="right")
    table.add_column("status", no_wrap=True)
    for case in result.cases:
        table.add_row(
            f"{case.mass_kg / 1e3:g} t",
            f"{case.oil_bulk_modulus_pa / 1e6:g} MPa",
            str(case.seed),
            *(one.text(case.figure(one.key)) for one in TABULATED),
            verdict(case.status.value, good=case.stable),
        )
    console.print(table)
    for case in result.cases:
        if case.broken:
            console.print(
                f"{case.mass_kg / 1e3:g} t, oil {case.oil_bulk_modulus_pa / 1e6:g} MPa, seed "
                f"{case.seed}: {case.broken} from {case.broken_at_s:.1f} s on"
            )


def files(paths: Iterable[Path]) -> None:
    """Print what was written."""
    for path in paths:
        console.print(Text(f"wrote {path}"), soft_wrap=True)


def ledger() -> None:
    """Print the ledger of disagreements with the paper."""
    table = Table(title="Where mptune differs from the paper", show_lines=True)
    for heading in ("where", "the paper reads", "used here", "why"):
        table.add_column(heading, ratio=2 if heading == "why" else 1)
    for entry in LEDGER:
        table.add_row(*(Text(text) for text in (entry.where, entry.reads, entry.used, entry.why)))
    console.print(table)
