"""What the commands print for people: the report's own tables, and progress on stderr."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import (
    BarColumn,
    ProgressColumn,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.progress import Progress as Bars

from mptune.cli.interrupt import interruptible
from mptune.cli.stages import telling
from mptune.cli.terminal import as_json, files, opening, say, show

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from mptune.params.judged_on import Difference
    from mptune.progress import Progress
    from mptune.robust.chain import Link
    from mptune.robust.headline import Judgement
    from mptune.robust.result import SweepResult
    from mptune.verify.result import VerifyResult

__all__ = [
    "as_json", "bars", "elsewhere", "files", "headline", "ledger", "progress", "say", "sweep",
    "verified",
]  # fmt: skip

_ROOM_FOR_A_BAR = 80  # columns; on fewer the numbers beside it would be cut


@contextmanager
def bars(*columns: ProgressColumn, quiet: bool) -> Iterator[tuple[Callable[[], None], Bars]]:
    """Yield bars on stderr, and what to call now and then so that an interrupt gets through."""
    errors = Console(stderr=True)
    spinner = SpinnerColumn("dots" if errors.encoding.startswith("utf") else "line")
    bar = [BarColumn()] if errors.width >= _ROOM_FOR_A_BAR else []
    first = spinner, TextColumn("{task.description}"), *bar
    with (
        interruptible() as check,
        Bars(*first, *columns, console=errors, transient=True, disable=quiet) as made,
    ):
        yield check, made


@contextmanager
def progress(*, quiet: bool) -> Iterator[Progress]:
    """Yield a function that takes a stage's name and the share of it that is done."""
    columns = TimeElapsedColumn(), TimeRemainingColumn()
    with (
        telling(quiet=quiet) as stages,
        bars(*columns, quiet=quiet) as (check, made),
    ):
        tasks: dict[str, Any] = {}

        def report(stage: str, share: float) -> None:
            check()
            stages.take(stage, share)
            for known, task in tasks.items():
                if known != stage:
                    made.update(task, total=1.0, completed=1.0)
            if stage not in tasks:
                tasks[stage] = made.add_task(stage, total=None)
            if share > 0:
                made.update(tasks[stage], total=1.0, completed=share)

        yield report


def headline(judgement: Judgement) -> None:
    """Print the verdict with its reason, which comes first wherever gains are judged."""
    from mptune.report.blocks import verdict
    from mptune.report.content.front import verdict_line

    say(verdict(verdict_line(judgement), good=judgement.met))


def elsewhere(found: Sequence[Difference]) -> None:
    """Print in what a model differs from the one that gains were made for, if in anything."""
    from mptune.report.content.front import differs

    if found:
        show(differs(found))


def sweep(result: SweepResult, chain: tuple[Link, ...] = ()) -> None:
    """Print both conditions, the family's margins, the requirements, and the chain at F_ref."""
    from mptune.report.content.certificates import bounds, radii
    from mptune.report.content.front import requirements, warnings
    from mptune.report.content.gain_chain import gain_factors
    from mptune.report.content.loops import conditions, margins

    opening((), warnings(result))
    show(conditions({"": result}), margins(result))
    if result.certificates is not None:
        show(bounds(result.certificates), radii(result.certificates))
    show(requirements(result.checks))
    if chain:
        show(gain_factors(chain))


def verified(result: VerifyResult) -> None:
    """Print each machine's figures and status."""
    from mptune.report.content.closed_loop import busiest_valve, machines
    from mptune.report.content.commanded import commanded_speeds
    from mptune.report.content.front import standing

    opening([], standing(result.study))
    show(*filter(None, (machines(result), commanded_speeds(result))))
    say(busiest_valve(result))


def ledger() -> None:
    """Print the ledger of disagreements with the paper."""
    from mptune.report.content.parameters import ledger as chapter

    show(*chapter().blocks, ruled=True)
