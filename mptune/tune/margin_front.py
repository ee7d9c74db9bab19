"""Tracking against robustness: the least index for each disk margin that is asked of F_ref."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.certify.bounds import bound
from mptune.params.controller import Gains
from mptune.progress import silent
from mptune.robust.certificates import certified_problem
from mptune.robust.model import LinearModel
from mptune.robust.sweep import noises_of
from mptune.strict import strict
from mptune.summary import Summarised
from mptune.tune.front import asking_for
from mptune.tune.polish import ITERATIONS
from mptune.tune.tuner import Tuner

if TYPE_CHECKING:
    from mptune.params.controller import Feedforward
    from mptune.params.estimator import Estimator
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.tune.objective import Figures
    from mptune.tune.space import Choice

LARGEST = 0.8  # disk margin: a gain margin of at least 2.3, a phase margin of 44°
_ITERATIONS = 40  # of a polish from the neighbour, which is near; it goes on while that pays


@dataclass(frozen=True)
class MarginPoint(Summarised):
    """The best tracking at a disk margin.

    Attributes
    ----------
    asked
        The disk margin asked for.
    gains, feedforward, estimator
        What was found.
    figures
        Its figures of merit, of the grid: a grid can only miss worse plants.
    guaranteed
        The disk margin that no plant of the box falls below; NaN where nothing is certified.
    noise_force
        Rms of F_ref that all sensors' noise makes [N].
    converged
        Whether the search converged.
    """

    asked: float
    gains: Gains
    feedforward: Feedforward
    estimator: Estimator
    figures: Figures
    guaranteed: float
    noise_force: float
    converged: bool

    @property
    def headline(self) -> str:
        """Disk margin and index."""
        figures = self.figures
        return f"disk margin {figures.disk_margin:.3g}, index {1e3 * figures.tracking:.4g} ms"

    def put_over(self, study: ResolvedStudy) -> ResolvedStudy:
        """Return a study with this point's gains, feed-forward and estimator as its own."""
        chosen = {name: getattr(self, name) for name in ("gains", "feedforward", "estimator")}
        return study.model_copy(update={"study": study.study.model_copy(update=chosen)})

    def json(self) -> dict[str, Any]:
        """Return the point in SI, units in the keys."""
        return strict(
            {
                "asked": self.asked,
                "gains": self.gains.model_dump(),
                "feedforward": self.feedforward.model_dump(),
                "estimator": self.estimator.model_dump(),
                "figures": self.figures.json(),
                "disk_margin_guaranteed": self.guaranteed,
                "noise_force_n": self.noise_force,
                "converged": self.converged,
            }
        )


def margin_front(
    study: ResolvedStudy,
    count: int,
    largest: float = LARGEST,
    progress: Progress = silent,
    start: Choice | None = None,
) -> tuple[MarginPoint, ...]:
    """Return the least tracking index for each of ``count`` disk margins at F_ref as it runs.

    They run from what the best tracking has anyway to ``largest``. Each is a local optimum on the
    study's grid, started from its neighbour; its disk margin over the whole box stands beside it.
    Margins at which no search met the study's other requirements are left out.

    Parameters
    ----------
    study
        The study; its own objective is not used, nor its requirement on the disk margin.
    count
        Number of points.
    largest
        The largest disk margin.
    progress
        Told of the stage ``"front"``.
    start
        Where the first search starts, the best tracking if it is known; from all over where None.
    """
    tracking = asking_for(study, "tracking")
    tuner = Tuner(_keeping(tracking, None))
    if tuner.blocked:
        return ()
    budget = ITERATIONS if start is None else _ITERATIONS
    found = tuner.searched(first=start, iterations=budget)[1]
    least = tuner.figures(found.choice).disk_margin
    points, last = [], found.choice
    if found.feasible:
        points.append(_point(tracking, tuner, found.choice, least, converged=found.converged))
    for n, asked in enumerate(np.linspace(least, largest, count)[1:], 1):
        progress("front", n / count)
        tuner = Tuner(_keeping(tracking, float(asked)))
        found = tuner.searched(first=last, iterations=_ITERATIONS)[1]
        if found.feasible:
            last, converged = found.choice, found.converged
            points.append(_point(tracking, tuner, last, float(asked), converged=converged))
    progress("front", 1.0)
    return tuple(points)


def _keeping(study: ResolvedStudy, margin: float | None) -> ResolvedStudy:
    """Return the study with another requirement on the disk margin."""
    asked = study.study.requirements.model_copy(update={"disk_margin": margin})
    inner = study.study.model_copy(update={"requirements": asked})
    return study.model_copy(update={"study": inner})


def _point(
    study: ResolvedStudy, tuner: Tuner, choice: Choice, asked: float, *, converged: bool
) -> MarginPoint:
    model = choice.put_over(LinearModel.of(study))
    problem = certified_problem(model, choice.gains)
    proved = bound(problem, "force_reference", "sampled", "disk_margin") if problem else None
    return MarginPoint(
        asked=asked,
        gains=Gains.model_validate(choice.gains._asdict(), context={"si": True}),
        feedforward=choice.feedforward,
        estimator=choice.estimator,
        figures=tuner.figures(choice),
        guaranteed=proved.bound if proved else float("nan"),
        noise_force=noises_of(model, choice.gains)["noise_force"],
        converged=converged,
    )
