"""The tuner: the largest velocity gain, then the search, then the verdict of the whole family."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.params.controller import Gains
from mptune.progress import silent
from mptune.robust.model import LinearModel
from mptune.robust.result import Status
from mptune.robust.sweep import sweep
from mptune.tune.objective import Judge
from mptune.tune.result import Blocking, TuneResult, TuneStatus
from mptune.tune.search import GainSearch, Searched, nothing
from mptune.tune.space import Choice
from mptune.tune.velocity import largest_velocity_gain

if TYPE_CHECKING:
    from mptune.params.pack import LoopGains
    from mptune.params.section import Range
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.robust.result import SweepResult
    from mptune.tune.objective import Figures
    from mptune.tune.velocity import VelocityGain


_REMEDIES = {  # where the figure itself is not what stands in the way
    Status.NOT_EVALUATED: "some total delay is below half a sampling period: no sampled loop to "
    "ask",
    Status.UNDECIDED: "with the best gains found it is undecided whether every loop is stable: "
    "measured responses may need finer steps or a wider band",
    Status.UNSTABLE: "with the best gains found some loop is unstable",
    Status.NOT_CONVERGED: "with the best gains found the worst ratio did not settle",
}


def tune(
    study: ResolvedStudy,
    progress: Progress = silent,
    *,
    structure: str = "eq22",
    extra: dict[str, Range] | None = None,
) -> TuneResult:
    """Return gains that satisfy the study's requirements, and how well they do.

    Parameters
    ----------
    study
        The study; its own gains are the starting point.
    progress
        Told of the stage ``"tune"``.
    structure
        Structure of the position controller, see ``mptune.tune.space``.
    extra
        Bounds of single parameters in SI that replace the study's.
    """
    tuner = Tuner(study)
    return tuner.tuned(structure, extra, progress)


class Tuner:
    """One study's tuning: what every structure and every bound shares is computed once."""

    def __init__(self, study: ResolvedStudy) -> None:
        self._study, self._model = study, LinearModel.of(study)
        model, bounds = self._model, study.study.requirements.bounds
        self._own = Choice(model.gains, study.study.feedforward)
        self._judge = Judge(model, self._own)
        self._before = self._judge.figures(self._own)
        self._velocity = largest_velocity_gain(
            model, bounds.k_p_vel[1] if bounds.k_p_vel else np.inf
        )
        self._least = bounds.k_p_vel[0] if bounds.k_p_vel else 0.0

    @property
    def before(self) -> Choice:
        """The study's own gains and feed-forward."""
        return self._own

    @property
    def blocked(self) -> bool:
        """Whether no velocity gain within the study's bounds meets Eq. 17's requirement."""
        return self._velocity.k_p_vel == 0 or self._velocity.k_p_vel < self._least

    def figures(self, choice: Choice) -> Figures:
        """Return the figures of merit of a candidate."""
        return self._judge.figures(choice)

    def tuned(
        self,
        structure: str = "eq22",
        extra: dict[str, Range] | None = None,
        progress: Progress = silent,
    ) -> TuneResult:
        """Return the tuned gains of one structure, with the whole family's verdict."""
        if self.blocked:
            why = _velocity_blocking(self._model, self._velocity)
            return self._result(structure, nothing(self._own), sweep(self._model), why)
        search, found = self.searched(structure, extra, None, progress)
        judged = sweep(self._model, _gains(found.choice.gains))
        blocking: Blocking | None = None
        if not found.feasible:
            blocking = self._search_blocking(search, found)
        elif not judged.satisfied:
            blocking = _sweep_blocking(judged)
        return self._result(structure, found, judged, blocking)

    def searched(
        self,
        structure: str = "eq22",
        extra: dict[str, Range] | None = None,
        first: Choice | None = None,
        progress: Progress = silent,
    ) -> tuple[GainSearch, Searched]:
        """Return a search and its outcome, without the whole family's verdict."""
        k_p_vel = self._velocity.k_p_vel
        search = GainSearch(self._model, self._judge, self._before, k_p_vel, structure, extra)
        return search, search.run(first, progress)

    def _result(
        self,
        structure: str,
        found: Searched,
        judged: SweepResult,
        blocking: Blocking | None,
    ) -> TuneResult:
        status = TuneStatus.OPTIMAL if found.converged else TuneStatus.NOT_CONVERGED
        return TuneResult(
            status=TuneStatus.INFEASIBLE if blocking else status,
            structure=structure,
            gains=judged.gains,
            feedforward=found.choice.feedforward,
            before=self._study.study.gains,
            figures=self._judge.figures(found.choice),
            figures_before=self._judge.figures(self._own),
            velocity=self._velocity,
            sweep=judged,
            blocking=blocking,
            binding=found.binding,
            rounds=found.rounds,
            evaluations=found.evaluations,
        )

    def _search_blocking(self, search: GainSearch, found: Searched) -> Blocking:
        """Return the requirement that the search could not meet, and how far each would give."""
        worst = max(found.worst, key=lambda one: one.excess)
        reliefs = search.reliefs(found)
        own = next((one for one in reliefs if one.requirement == worst.requirement), None)
        remedy = f"the nearest gains found are {np.exp(worst.excess):.3g} times off"
        if own is not None and np.isfinite(own.factor):
            remedy += f"; with the others kept it would have to give by a factor {own.factor:.3g}"
        return Blocking(
            worst.requirement, float(np.exp(worst.excess)), worst.at(self._model), remedy, reliefs
        )


def _gains(packed: LoopGains) -> Gains:
    return Gains.model_validate(packed._asdict(), context={"si": True})


def _velocity_blocking(model: LinearModel, velocity: VelocityGain) -> Blocking:
    at = model.point(velocity.plant, velocity.frequency)
    if velocity.k_p_vel > 0:
        return Blocking(
            "velocity_ratio",
            velocity.k_p_vel,
            at,
            f"Eq. 17 allows a velocity gain up to {velocity.k_p_vel:.4g} N s/m, below the study's "
            "bound; allow more of the ratio or lower the bound",
        )
    least = abs(model.nominal.mass / at.mass_kg - 1)
    return Blocking(
        requirement="velocity_ratio",
        least_found=least,
        at=at,
        remedy=(
            f"as the frequency vanishes the left/right ratio of Eq. 17 tends to {least:.3g} at any "
            "gain; allow more, narrow the mass range or move uncertainty.nominal.mass inside it"
        ),
    )


def _sweep_blocking(judged: SweepResult) -> Blocking:
    """Return the first requirement that the best gains found do not meet."""
    check = next(check for check in judged.checks if check.status is not Status.SATISFIED)
    remedy = _REMEDIES.get(
        check.status, f"the best gains found reach {check.found:.3g} where {check.limit} is asked"
    )
    return Blocking(check.label, check.found, check.at, remedy)
