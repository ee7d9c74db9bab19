"""What ``mptune weights`` prints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.cli.terminal import say, show
from mptune.report.blocks import verdict
from mptune.report.content.weights import trials

if TYPE_CHECKING:
    from mptune.weigh.result import WeightsResult


def weights(result: WeightsResult) -> None:
    """Print the paper's order, the front and the recommendation."""
    found = result.json()
    steps = [
        {**step, "name": f"{step['weight']}, {'kept' if step['kept'] else 'not kept'}"}
        for step in found["steps"]
    ]
    own = "the study's own"
    front = [
        {**one, "name": f"trial {one['trial']}" if one["trial"] else f"trial 0, {own}"}
        for one in found["front"]
    ]
    again = [
        {**found["own"], "name": own},
        {**found["recommended"], "name": "recommended"},
        {**found["spreads"], "name": "spread"},
    ]
    first = "W_conv, then W_loss" if result.study.study.converters else "W_loss"
    usable = f"{found['trials']} trials, {found['usable_trials']} of them usable"
    show(
        trials(f"§5.4's order: {first}, then W_sw", steps),
        trials(f"Pareto front of {usable}", front),
        trials("Again, with random numbers that the search has not seen", again),
    )
    good = result.satisfied
    word = f"{'dominate' if good else 'do not dominate'} {own}"
    say("The recommended weights", verdict(word, good=good), f"- {found['reason']}.")
