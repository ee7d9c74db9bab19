"""Tracking against disturbance rejection: the Pareto front, one point per integral gain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from mptune.interop import Drawn, to_pandas
from mptune.params.controller import Gains
from mptune.params.requirements import Objective
from mptune.progress import silent
from mptune.strict import strict
from mptune.summary import Summarised
from mptune.tune.tuner import Tuner

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd

    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.tune.objective import Figures
    from mptune.tune.search import Searched

POINTS = 8


@dataclass(frozen=True)
class FrontPoint(Summarised):
    """One point: the best tracking at an integral gain, and whether the search converged."""

    gains: Gains
    figures: Figures
    converged: bool

    @property
    def headline(self) -> str:
        """Integral gain, index, and whether the search converged."""
        gain, index = self.figures.integral_gain, 1e3 * self.figures.tracking
        converged = "converged" if self.converged else "not converged"
        return f"K_I,pos {gain:.4g} 1/s², index {index:.4g} ms, {converged}"

    def json(self) -> dict[str, Any]:
        """Return the point in SI, units in the keys."""
        figures = self.figures.json()
        values = {"gains": self.gains.model_dump(), "figures": figures, "converged": self.converged}
        return strict(values)


@dataclass(frozen=True, repr=False)
class Front(Summarised, Drawn):
    """The front, integral gains rising, and where the study's own gains lie."""

    drawings: ClassVar[Mapping[str, str]] = {"front": "mptune.figures.tradeoff:pareto_front"}

    points: tuple[FrontPoint, ...]
    own: Figures

    @property
    def headline(self) -> str:
        """How many points there are."""
        return f"Front of tracking against disturbance: {len(self.points)} points"

    def json(self) -> list[dict[str, Any]]:
        """Return the points in SI, units in the keys."""
        return [point.json() for point in self.points]

    def to_pandas(self) -> pd.DataFrame:
        """Return one row per point."""
        return to_pandas(self.points)


def front(
    study: ResolvedStudy,
    count: int = POINTS,
    progress: Progress = silent,
) -> Front:
    """Return the least tracking index for each of ``count`` integral gains.

    The gains run from where tracking is best to the largest integral gain that the requirements
    allow; below the first, both figures would be worse. Each is a local optimum, started from its
    neighbour. Points that no search could make meet the requirements are left out; all of them
    where no velocity gain meets Eq. 17's.

    Parameters
    ----------
    study
        The study; its own objective is not used.
    count
        Number of integral gains.
    progress
        Told of the stage ``"front"``.
    """
    tracking = asking_for(study, "tracking")
    tuner = Tuner(tracking)
    if tuner.blocked:
        return Front((), tuner.figures(tuner.before))
    best = tuner.certified()[1]
    most = Tuner(asking_for(study, "disturbance")).certified()[1]
    low, high = best.choice.gains.k_i_pos, most.choice.gains.k_i_pos
    found, last = [best], best
    for n, k_i in enumerate(np.linspace(low, high, count)[1:-1]):
        progress("front", n / count)
        at = {"k_i_pos": (float(k_i), float(k_i))}
        last = tuner.certified(extra=at, first=last.choice)[1]
        found.append(last)
    found.append(most)
    points = [_point(tuner, one) for one in found if one.feasible]
    progress("front", 1.0)
    return Front(tuple(points), tuner.figures(tuner.before))


def asking_for(study: ResolvedStudy, kind: str) -> ResolvedStudy:
    """Return the study with another objective, on the same loop and with the same freedom."""
    old = study.study.objective
    where = {"tracking_loop": old.tracking_loop, "tracking_plants": old.tracking_plants}
    objective = Objective.model_validate({"kind": kind, "free": old.turned, **where})
    inner = study.study.model_copy(update={"objective": objective})
    return study.model_copy(update={"study": inner})


def _point(tuner: Tuner, found: Searched) -> FrontPoint:
    gains = Gains.model_validate(found.choice.gains._asdict(), context={"si": True})
    return FrontPoint(gains, tuner.figures(found.choice), found.converged)
