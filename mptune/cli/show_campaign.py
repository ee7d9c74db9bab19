"""What ``mptune campaign`` prints."""

from __future__ import annotations

import math
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.progress import MofNCompleteColumn, ProgressColumn, TimeRemainingColumn
from rich.text import Text

from mptune.campaign.draw import PARAMETER_UNITS
from mptune.campaign.guarantee import runs_table
from mptune.campaign.result import QUANTILES, draw_json
from mptune.campaign.simulate import FIGURES
from mptune.cli.show import bars
from mptune.cli.terminal import as_json, say, show
from mptune.report.blocks import Column, Row, Tabular, left, right, verdict
from mptune.sim.merit import OF_CONVERTERS, OF_SPEEDS, merit
from mptune.units import number, shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rich.progress import Task

    from mptune.campaign.adversary import WorstMachine
    from mptune.campaign.draw import Draw
    from mptune.campaign.plan import Plan
    from mptune.campaign.result import CampaignResult
    from mptune.progress import Progress
    from mptune.verify.result import CaseResult

_SHOWN = (0.05, 0.5, 0.95)


class _Rate(ProgressColumn):
    """Runs per second."""

    def render(self, task: Task) -> Text:
        return Text("" if task.speed is None else f"{task.speed:.1f} runs/s")


@contextmanager
def progress(runs: int, *, quiet: bool) -> Iterator[Progress]:
    """Yield what is told the share of so many runs that is done; show their rate and time left."""
    columns = MofNCompleteColumn(), _Rate(), TimeRemainingColumn()
    with bars(*columns, quiet=quiet) as (check, made):
        task = made.add_task("runs", total=None)

        def report(_stage: str, share: float) -> None:
            check()
            made.update(task, total=runs, completed=round(share * runs))

        yield report


def campaign(result: CampaignResult) -> None:
    """Print distributions, worst cases, failures and what they guarantee."""
    title = f"{result.plan.runs} runs ({result.plan.study.study.campaign.method})"
    columns = [*left("Figure"), *right(*(f"{100 * share:g} %" for share in _SHOWN), "Worst", "Run")]
    columns.append(Column("Goes most with (rank correlation)"))
    shown_figures = [figure for figure in FIGURES if _known(result, figure)]
    show(Tabular(title, columns, [_distribution(result, figure) for figure in shown_figures]))
    say(_drawn(result.plan))
    for reason, count in result.reasons().items():
        say(f"failed: {count} of {result.plan.runs}, {reason}")
    duty = 100 * result.plan.study.study.verification.duty
    say(
        f"The busiest valve of any run switches {number(result.busiest_per_year / 1e6)} million "
        f"times a year at a duty of {duty:g} %."
    )
    say(_guarantee(result))
    met = result.satisfied
    say(verdict("satisfied" if met else "violated", good=met))


def _drawn(plan: Plan) -> str:
    """Return the ranges that were drawn from."""
    units, box = tuple(PARAMETER_UNITS.items()), plan.box
    ranges = [
        f"{units[place][0].replace('_', ' ')} "
        + shown((float(box.low[place]), float(box.high[place])), units[place][1], ranged=True)
        for place in box.varying
    ]
    return f"Drawn: {'; '.join(ranges) or 'nothing'}."


def _known(result: CampaignResult, figure: str) -> bool:
    """Return whether a figure is shown: of speeds where a run has any, so of converters."""
    one = merit(figure)
    if one is OF_CONVERTERS:
        return result.plan.study.study.converters > 0
    return one not in OF_SPEEDS or bool(np.isfinite(result.column(figure)).any())


def _distribution(result: CampaignResult, figure: str) -> Row:
    quantiles = dict(zip(QUANTILES, result.quantiles(figure), strict=True))
    worst = result.worst_run(figure)
    return [
        figure,
        *(number(quantiles[share]) for share in _SHOWN),
        number(math.nan if worst is None else float(result.column(figure)[worst])),
        "—" if worst is None else str(worst),
        _strongest(result.correlations(figure)),
    ]


def _strongest(correlations: dict[str, float]) -> str:
    known = {name: value for name, value in correlations.items() if not math.isnan(value)}
    order = sorted(known, key=lambda name: -abs(known[name]))
    return ", ".join(f"{name} {known[name]:+.2f}" for name in order[:2])


def _guarantee(result: CampaignResult) -> str:
    found = result.guarantee
    if found is None:
        return (
            "No guarantee: points of a grid or of Sobol' are no independent draws; "
            'take campaign.method = "monte carlo" for one.'
        )
    return (
        f"{found.failures} of {found.runs} failed: with a confidence of 1 − {found.doubt:g} a "
        "machine drawn uniformly from these ranges fails with a probability below "
        f"{found.failure_probability:.3g} (Clopper and Pearson)."
    )


def needed(failure_probability: float, doubt: float, *, json: bool) -> None:
    """Print how many runs guarantee a failure probability."""
    runs = runs_table(failure_probability, doubt)
    if json:
        asked = {"failure_probability": failure_probability, "doubt": doubt}
        as_json({**asked, "runs_by_failures": {str(most): count for most, count in runs.items()}})
        return
    say(
        f"For a failure probability below {failure_probability:g} with a confidence of "
        f"1 − {doubt:g}, by independent draws:"
    )
    for failures, count in runs.items():
        say(f"{count} runs, if {failures} of them fail")


def replay_json(plan: Plan, run: int, case: CaseResult, reason: str) -> dict[str, Any]:
    """Return one run's parameters, figures and fate."""
    return {
        "run": run,
        "identity": plan.identity(),
        "parameters": draw_json(plan.draw(run)),
        "reason": reason,
        **case.json(),
    }


def replayed(plan: Plan, run: int, case: CaseResult, reason: str) -> None:
    """Print one run."""
    say(_machine(plan.draw(run)))
    rows: list[Row] = [[figure, number(case.figure(figure), 6)] for figure in FIGURES]
    show(Tabular(f"Run {run}", [*left("Figure"), *right("Value")], rows))
    say("Status:", verdict(reason or case.status.value, good=not reason))


def worst(found: WorstMachine) -> None:
    """Print the worst machine of a search."""
    say(_machine(found.draw))
    low, high = found.other_noise.min(), found.other_noise.max()
    say(
        f"{found.figure} {number(found.value)}; under other sensor noise {number(low)} to "
        f"{number(high)}. The worst of {found.evaluations} machines searched, which may miss "
        "a worse one."
    )
    reason = found.reason
    say("Status:", verdict(reason or found.status, good=not reason))


def _machine(draw: Draw) -> str:
    return "; ".join(
        f"{name.replace('_', ' ')} {shown(value, unit)}"
        for (name, unit), value in zip(PARAMETER_UNITS.items(), draw, strict=True)
    )
