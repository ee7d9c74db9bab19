"""Which of the trials to take: the Pareto front, its knee, and whether the study's own is beaten.

A trial that won a search was also lucky with its random numbers. The few that could be recommended
therefore run again with others, beside the study's own weights, and only those figures count.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mptune.progress import silent
from mptune.summary import Summarised
from mptune.weigh.trial import OBJECTIVES, Trial, limits_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.arrays import BoolArray, FloatArray
    from mptune.progress import Progress
    from mptune.weigh.trial import Bench, Limits

FINALISTS = 6
STAGE = "the best again, with other random numbers"
_CLEARLY = 2.0  # spreads by which a figure is clearly better
_ENOUGH = 10.0  # spreads beyond which better counts no more


@dataclass(frozen=True, repr=False)
class Recommendation(Summarised):
    """What to take, and why.

    Attributes
    ----------
    trial, own
        The recommended weights and the study's own, both with the second random numbers.
    spreads
        ``(4,)`` seed-to-seed spread of each objective with the study's own weights.
    reason
        Why these, in words.
    dominates
        Whether no figure is worse by more than its spread and one is clearly better.
    """

    trial: Trial
    own: Trial
    spreads: FloatArray
    reason: str
    dominates: bool = False

    @property
    def headline(self) -> str:
        """The weights to take, and why."""
        return f"{self.trial.headline}; {self.reason}"


def front(trials: Sequence[Trial], limits: Limits) -> tuple[int, ...]:
    """Return the places of the usable trials that no usable trial beats in every objective."""
    usable = [place for place, trial in enumerate(trials) if limits.keeps(trial)]
    values = _objectives([trials[place] for place in usable])
    return tuple(place for place, best in zip(usable, not_dominated(values), strict=True) if best)


def not_dominated(values: FloatArray) -> BoolArray:
    """Return which rows of ``(T, 4)`` no other row is at most as large as, and smaller once."""
    no_worse = (values[:, None] <= values[None]).all(axis=2)
    better = (values[:, None] < values[None]).any(axis=2)
    return np.asarray(~(no_worse & better).any(axis=0))


def knee(values: FloatArray) -> int:
    """Return the row of ``(T, 4)`` nearest to the least of every column, each over its range."""
    low, high = values.min(axis=0), values.max(axis=0)
    scaled = (values - low) / np.where(high > low, high - low, 1.0)
    return int(np.argmin((scaled**2).sum(axis=1)))


def recommended(
    bench: Bench,
    own: Trial,
    candidates: Sequence[Trial],
    progress: Progress = silent,
) -> Recommendation:
    """Return the weights to take among the front's.

    Parameters
    ----------
    bench
        With random numbers that the search has not seen.
    own, candidates
        The study's own weights and the front, as the search saw them.
    progress
        Told of the stage ``STAGE``.
    """
    progress(STAGE, 0.0)
    again = bench.tried(own.weights)
    limits = limits_of(bench.study, again)
    progress(STAGE, 1 / (FINALISTS + 1))
    spreads = np.array([again.spread(figure) for figure in OBJECTIVES])
    finalists = []
    for candidate in _finalists(own, candidates, spreads):
        finalists.append(bench.tried(candidate.weights))
        progress(STAGE, min((len(finalists) + 1) / (FINALISTS + 1), 1.0))
    usable = [trial for trial in finalists if limits.keeps(trial)]
    if not usable:
        reason = "no other usable weights were found; search with more trials"
        return Recommendation(again, again, spreads, reason)
    gains = [_gains(again, trial, spreads) for trial in usable]
    dominating = [
        place for place, gain in enumerate(gains) if (gain >= -1).all() and gain.max() >= _CLEARLY
    ]
    if dominating:
        best = max(dominating, key=lambda place: _merit(gains[place]))
        reason = f"against the study's own: {_said(again, usable[best])}"
        return Recommendation(usable[best], again, spreads, reason, dominates=True)
    best = knee(_objectives(usable))
    worse = [name for name, gain in zip(OBJECTIVES, gains[best], strict=True) if gain < -1]
    blocked = (
        f"every trial of the front that is clearly better in one figure is worse in another by "
        f"more than its spread; at the knee that is {', '.join(worse)}"
        if worse
        else "no trial that loses nothing is clearly better in any figure"
    )
    reason = f"the knee of the front: {_said(again, usable[best])}; {blocked}"
    return Recommendation(usable[best], again, spreads, reason)


def _finalists(own: Trial, candidates: Sequence[Trial], spreads: FloatArray) -> list[Trial]:
    """Return the trials that look best against the study's own, and the knee."""
    others = [trial for trial in candidates if trial.weights != own.weights]
    if not others:
        return []
    merits = [_merit(_gains(own, trial, spreads)) for trial in others]
    order = sorted(range(len(others)), key=lambda place: merits[place])
    chosen = order[-(FINALISTS - 1) :]
    places = dict.fromkeys([knee(_objectives(others)), *reversed(chosen)])
    return [others[place] for place in places]


def _gains(own: Trial, trial: Trial, spreads: FloatArray) -> FloatArray:
    """Return by how many spreads each objective is smaller than with the study's own weights."""
    less = np.array(own.objectives) - np.array(trial.objectives)
    return np.asarray(less / np.maximum(spreads, 1e-12 * np.abs(own.objectives)))


def _merit(gains: FloatArray) -> float:
    """Return how good gains in spreads are: what is lost counts ten times what is won."""
    return float(_ENOUGH * min(gains.min(), 0.0) + np.clip(gains, None, _ENOUGH).sum())


def _objectives(trials: Sequence[Trial]) -> FloatArray:
    return np.array([trial.objectives for trial in trials], np.float64).reshape(-1, len(OBJECTIVES))


def _said(own: Trial, trial: Trial) -> str:
    changes = (
        f"{name} {100 * (new / old - 1):+.1f} %"
        for name, old, new in zip(OBJECTIVES, own.objectives, trial.objectives, strict=True)
    )
    return ", ".join(changes)
