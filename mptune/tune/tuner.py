"""The tuner: the largest velocity gain, then the search, then the verdict of the whole family."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.certify.result import Grounds
from mptune.params.controller import Gains
from mptune.progress import silent
from mptune.robust.certificates import place_of
from mptune.robust.model import LinearModel
from mptune.robust.result import Status
from mptune.robust.sweep import sweep
from mptune.tune.excess import AS_IT_RUNS
from mptune.tune.objective import Judge
from mptune.tune.polish import ITERATIONS
from mptune.tune.result import Blocking, TuneResult, TuneStatus
from mptune.tune.search import GainSearch, Searched, nothing
from mptune.tune.space import Choice
from mptune.tune.velocity import largest_velocity_gain

if TYPE_CHECKING:
    from mptune.params.packed import LoopGains
    from mptune.params.section import Range
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.robust.place import PlantPoint
    from mptune.robust.result import Check, SweepResult
    from mptune.tune.objective import Figures
    from mptune.tune.velocity import VelocityGain


_TIGHTENED = 8  # times that a certificate may find what the search had missed
_OFF = 2e-3  # of a disk margin: a certificate that finds less by less changes nothing
_ACROSS = 2e-5  # logarithm kept in hand where a proof lies across a limit
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
        self._hand: dict[str, float] = {}
        self._own = Choice.of(model)
        self._judge = Judge(model, self._own)
        self._before = self._judge.figures(self._own)
        self._velocity = self._largest_velocity_gain()
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
            return self._result(structure, nothing(self._own), self._judged(self._own), why)
        search, found, judged = self.certified(structure, extra, None, progress)
        blocking: Blocking | None = None
        if not found.feasible:
            blocking = self._search_blocking(search, found)
        elif not judged.satisfied:
            blocking = _sweep_blocking(judged)
        return self._result(structure, found, judged, blocking)

    def certified(
        self,
        structure: str = "eq22",
        extra: dict[str, Range] | None = None,
        first: Choice | None = None,
        progress: Progress = silent,
    ) -> tuple[GainSearch, Searched, SweepResult]:
        """Return a search, its outcome and the verdict, searched again until certificates hold."""
        search, found = self.searched(structure, extra, first, progress)
        judged = self._judged(found.choice)
        for _ in range(_TIGHTENED):
            if not found.feasible or not self._learn(judged, found.choice):
                break
            search, found = self.searched(structure, extra, found.choice, progress)
            judged = self._judged(found.choice)
        return search, found, judged

    def _judged(self, choice: Choice) -> SweepResult:
        model = choice.put_over(self._model)
        return sweep(model, _gains(choice.gains), choice.feedforward)

    def searched(
        self,
        structure: str = "eq22",
        extra: dict[str, Range] | None = None,
        first: Choice | None = None,
        progress: Progress = silent,
        *,
        iterations: int = ITERATIONS,
    ) -> tuple[GainSearch, Searched]:
        """Return a search and its outcome, without the whole family's verdict."""
        k_p_vel = self._velocity.k_p_vel
        search = GainSearch(
            self._model,
            self._judge,
            self._before,
            k_p_vel,
            structure,
            extra,
            self._hand,
            iterations,
        )
        return search, search.run(first, progress)

    def _learn(self, judged: SweepResult, choice: Choice) -> bool:
        """Take up what a certificate found that the search had missed; return whether it did.

        The plant joins the family. Where it had joined already, the worst lies between frequencies
        and what was missed is kept in hand.
        """
        if judged.satisfied:
            return self._learn_margin(judged, choice)
        missed = [check for check in judged.checks if missed_by(self._model, check) > 0]
        for check in missed:
            if not self._joins(check.at, as_it_runs=check.key in AS_IT_RUNS):
                over = missed_by(self._model, check)
                self._hand[check.key] = self._hand.get(check.key, 0.0) + over
        self._velocity = self._largest_velocity_gain()
        return bool(missed)

    def _learn_margin(self, judged: SweepResult, choice: Choice) -> bool:
        """Take up a plant of the box whose disk margin is below all that the objective asked."""
        proofs = judged.certificates
        found = proofs.of("force_reference", "sampled", "disk_margin") if proofs else None
        if found is None or not self._study.study.objective.robust:
            return False
        known = self._judge.figures(choice).disk_margin
        return found.attained < (1 - _OFF) * known and self._joins(
            place_of(found.at), as_it_runs=True
        )

    def _joins(self, at: PlantPoint | None, *, as_it_runs: bool) -> bool:
        """Let a plant join the family; return whether it had not before."""
        if at is None or at.response is not None or not np.isfinite(at.delay_s):
            return False
        if self._model.holds(at, as_it_runs=as_it_runs):
            return False
        self._model = self._model.joined_by(at, as_it_runs=as_it_runs)
        self._judge.ask(self._model)
        return True

    def _largest_velocity_gain(self) -> VelocityGain:
        bounds = self._model.requirements.bounds
        upper = bounds.k_p_vel[1] if bounds.k_p_vel else np.inf
        hand = self._hand.get("velocity_ratio", 0.0)
        return largest_velocity_gain(self._model, upper, hand)

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
            estimator=found.choice.estimator,
            before=self._study.study.gains,
            estimator_before=self._study.study.estimator,
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


def missed_by(model: LinearModel, check: Check) -> float:
    """Return the logarithm by which a requirement on a ratio or margin is missed; 0 where met.

    Where only its certificate lies across the limit, a little.
    """
    if check.status is Status.UNDECIDED and check.grounds is Grounds.OPEN:
        return _ACROSS
    if check.status is not Status.VIOLATED or not hasattr(model.requirements, check.key):
        return 0.0
    limit = getattr(model.requirements, check.key)
    allowed = limit if isinstance(limit, float) else 1.0
    over = np.log(check.found / allowed)
    return float(abs(over)) + _ACROSS if np.isfinite(over) else 0.0


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
