"""What ``mptune tune`` prints: gains, what they gain, what limits them, and what they beat."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.cli.show import sweep
from mptune.cli.terminal import files, opening, show
from mptune.report.content.front import gains, tuning
from mptune.report.content.tradeoff import controllers, margin_points, points

if TYPE_CHECKING:
    from mptune.job.tune import Tuning
    from mptune.tune.result import TuneResult


def whole_tuning(result: Tuning) -> None:
    """Print a tuning with its comparison and front, where asked for."""
    tuned(result.tuned)
    if result.compared:
        show(controllers(one.json() for one in result.compared))
    if result.front is not None:
        show(points(result.front.json(), result.front.own.json()))
    if result.margins:
        show(margin_points(result.margins))
    files(result.files)


def tuned(result: TuneResult) -> None:
    """Print tuned gains, what they gain, and what limits them."""
    texts = tuning(result)
    if result.rounds:
        rounds = ", ".join(
            f"[{one.best:.4f}, {one.worst:.4f}] on {one.plants} plants" for one in result.rounds
        )
        words = "Rounds [objective over the study's own, worst quotient of the family]"
        texts.append(f"{words}: {rounds}")
    opening(texts, good=result.blocking is None)
    found = result.gains, result.feedforward, result.estimator
    own = result.sweep.study.study.feedforward
    show(gains(found, (result.before, own, result.estimator_before)))
    sweep(result.sweep)
