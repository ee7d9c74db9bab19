"""What ``mptune tune`` prints: gains, what they gain, what limits them, and what they beat."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.cli.show import console, files, gains, new_table, sweep, verdict
from mptune.robust.tables import place_text
from mptune.tune.baselines import LABELS
from mptune.units import number

if TYPE_CHECKING:
    from mptune.job.tune import Tuning
    from mptune.tune.baselines import Baseline
    from mptune.tune.front import Front
    from mptune.tune.objective import Figures
    from mptune.tune.result import Blocking, TuneResult


def tuning(result: Tuning) -> None:
    """Print a tuning with its comparison and front, where asked for."""
    tuned(result.tuned)
    if result.compared:
        _compared(result.compared)
    if result.front is not None:
        _front(result.front)
    files(result.files)


def tuned(result: TuneResult) -> None:
    """Print tuned gains, what they gain, and what limits them."""
    study = result.sweep.study.study
    gains(result.gains, result.before)
    if study.objective.free_feedforward:
        gains(result.feedforward, study.feedforward, title="Feed-forward")
    console.print("Status:", verdict(result.status.value, good=result.blocking is None))
    console.print(_figures(result))
    if result.rounds:
        rounds = ", ".join(
            f"[{one.best:.4f}, {one.worst:.4f}] on {one.plants} plants" for one in result.rounds
        )
        console.print(
            f"Rounds [objective over the study's own, worst quotient of the family]: {rounds}"
        )
    if result.binding:
        console.print(f"Binding: {', '.join(result.binding)}")
    if result.blocking is not None:
        _blocking(result.blocking)
    sweep(result.sweep)


def _figures(result: TuneResult) -> str:
    before, after = result.figures_before, result.figures
    loop = result.sweep.study.study.objective.tracking_loop
    return (
        f"Tracking index ({loop} loop) {1e3 * before.tracking:.2f} → "
        f"{1e3 * after.tracking:.2f} ms, "
        f"K_I,pos {before.integral_gain:.3g} → {after.integral_gain:.3g} 1/s², "
        f"load step {1e6 * before.load_step:.3g} → {1e6 * after.load_step:.3g} mm/kN, "
        f"bandwidth {before.bandwidth:.3g} → {after.bandwidth:.3g} rad/s"
    )


def _blocking(blocking: Blocking) -> None:
    console.print(
        f"Blocked by {blocking.requirement} at {place_text(blocking.at)}: {blocking.remedy}."
    )
    for relief in blocking.reliefs:
        console.print(
            f"  {relief.requirement}: would have to give by a factor {number(relief.factor)}"
        )


def _row(figures: Figures) -> tuple[str, ...]:
    return (
        f"{1e3 * figures.tracking:.2f}",
        f"{figures.integral_gain:.3g}",
        f"{1e6 * figures.load_step:.3g}",
        f"{figures.bandwidth:.3g}",
    )


_HEADINGS = ("index [ms]", "K_I,pos [1/s²]", "load step [mm/kN]", "bandwidth [rad/s]")


def _compared(rows: tuple[Baseline, ...]) -> None:
    table = new_table("Controllers under the same requirements")
    table.add_column("controller")
    for heading in (*_HEADINGS, "Eq. 17", "Eq. 21"):
        table.add_column(heading, justify="right")
    table.add_column("status")
    for one in rows:
        ratios = (f"{condition.worst_ratio:.3f}" for condition in one.sweep.conditions)
        status = one.status.value if one.status else "as published"
        table.add_row(
            LABELS[one.name],
            *_row(one.figures),
            *ratios,
            verdict(status, good=one.sweep.satisfied),
        )
    console.print(table)


def _front(front: Front) -> None:
    table = new_table("Tracking against disturbance")
    for heading in _HEADINGS:
        table.add_column(heading, justify="right")
    table.add_column("search")
    for point in front.points:
        table.add_row(*_row(point.figures), "converged" if point.converged else "not converged")
    table.add_row(*_row(front.own), "study's own")
    console.print(table)
