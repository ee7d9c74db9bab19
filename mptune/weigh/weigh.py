"""The weights of a study: §5.4's order, the search, the front and a recommendation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.progress import silent
from mptune.weigh.procedure import by_the_papers_order
from mptune.weigh.recommend import front, recommended
from mptune.weigh.result import WeightsResult
from mptune.weigh.search import open_search
from mptune.weigh.trial import Bench, limits_of, own_weights

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.campaign.workers import Workers
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress

SEARCH_SEEDS, SECOND_SEEDS = (1, 2), (11, 12, 13, 14)  # of the search, of the recommendation


def search_weights(
    study: ResolvedStudy,
    team: Workers,
    storage: str,
    trials: int = 80,
    *,
    sampler: str = "tpe",
    seed: int = 1,
    also: Sequence[str] = (),
    sets: int = 3,
    progress: Progress = silent,
) -> WeightsResult:
    """Find weights for a study's force controller.

    Parameters
    ----------
    study
        The study; its own weights are the first trial.
    team
        Who simulates.
    storage
        Address of optuna's database; a search that stands there is gone on with.
    trials
        How many in all.
    sampler, seed, also
        See ``open_search``.
    sets
        Movement sets per run; of several, the first is left out.
    progress
        Told of the three stages: the paper's order, the search, the best again.
    """
    bench = Bench(study, team, SEARCH_SEEDS, sets)
    search = open_search(bench, storage, seed=seed, sampler=sampler, also=also)
    own = bench.tried(own_weights(study))
    by_order, steps = by_the_papers_order(bench, own.weights, progress)
    limits = limits_of(study, own)
    tried = search.run(
        trials,
        (own.weights, by_order),
        limits,
        progress,
    )
    best = front(tried, limits)
    second = bench.with_seeds(SECOND_SEEDS)
    found = recommended(second, own, [tried[place] for place in best], progress)
    return WeightsResult(study, by_order, steps, tried, best, limits, found)
