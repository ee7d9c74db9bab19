"""The search of one structure's best gains: convex starts, polish, growing sets of plants."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from mptune.progress import silent
from mptune.tune.excesses import Excesses
from mptune.tune.objective import Judge, weights_of
from mptune.tune.polish import Polished, Values, polish
from mptune.tune.result import Concession, Round
from mptune.tune.space import Choice, Space, space_of
from mptune.tune.starts import first_points, screened

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from mptune.arrays import FloatArray
    from mptune.params.section import Range
    from mptune.progress import Progress
    from mptune.robust.model import LinearModel
    from mptune.tune.excesses import Excess
    from mptune.tune.objective import Figures

_ROUNDS = 8
_REPEATS, _GAINED = 6, 1e-3  # of a polish, and what makes another one worth its while
_SAME = 1e-4  # of the objective: two starts that end so near have found the same optimum
_LEAST_STARTS = 5  # before two that agree are believed
_BROKEN = 20.0  # weight of a broken requirement, as a logarithm, beside the cost's
_BINDING = 2e-3  # of a logarithm
_MET = 1e-5  # an excess that counts as none
_NO_INTEGRAL = 1e-6  # 1/s²: stands for a gain of 0, whose inverse is wanted


@dataclass(frozen=True)
class Searched:
    """The outcome of a search.

    Attributes
    ----------
    choice
        The best candidate; where infeasible, the nearest to the requirements.
    feasible, converged
        Whether every requirement is met over the whole family, and the last polish was stationary.
    worst
        Each requirement's worst over the whole family.
    """

    choice: Choice
    feasible: bool
    converged: bool
    worst: tuple[Excess, ...]
    binding: tuple[str, ...]
    rounds: tuple[Round, ...]
    evaluations: int


def nothing(choice: Choice) -> Searched:
    """Return the outcome where nothing was searched."""
    return Searched(
        choice, feasible=False, converged=False, worst=(), binding=(), rounds=(), evaluations=0
    )


class GainSearch:
    """One structure's search for one study.

    Parameters
    ----------
    model
        The study's linear model.
    judge
        Its figures of merit.
    before
        The figures that the objective is relative to.
    largest_velocity_gain
        The largest K_P,vel that meets Eq. 17's requirement [N s/m].
    structure
        One of ``mptune.tune.space.STRUCTURES``.
    extra
        Bounds that replace the study's.
    hand
        What is kept in hand of the requirements, see ``Excesses``.
    """

    def __init__(
        self,
        model: LinearModel,
        judge: Judge,
        before: Figures,
        largest_velocity_gain: float,
        structure: str = "eq22",
        extra: dict[str, Range] | None = None,
        hand: Mapping[str, float] | None = None,
    ) -> None:
        self._model, self._judge, self._before = model, judge, before
        self._space = space_of(model, largest_velocity_gain, structure, extra)
        own = model.gains.k_p_vel if self._space.crowded else largest_velocity_gain
        self._start = model.gains._replace(k_p_vel=min(own, largest_velocity_gain))
        self._required = Excesses(model, self._start, hand)
        self._weights = weights_of(model.study.study.objective)
        self._kept: dict[str, float] = {}  # earlier objectives and the most that they may become
        self._evaluations = 0

    @property
    def space(self) -> Space:
        """What is free."""
        return self._space

    def run(
        self,
        first: Choice | None = None,
        progress: Progress = silent,
    ) -> Searched:
        """Return the best candidate for the study's objective, then for those after it."""
        found = self._improve(self._starts(first), progress)
        objective = self._model.study.study.objective
        for kind in objective.then:
            if not found.feasible:
                break
            last = next(iter(self._weights))
            value = self._value(found.choice, last)
            self._kept[last] = value * (1 + objective.keep)
            self._weights = {kind: 1.0}
            better = self._improve([self._space.point(found.choice)], progress)
            found = better if better.feasible else found
        return found

    def reliefs(self, found: Searched) -> tuple[Concession, ...]:
        """Return how far each requirement would have to give, on the plants that bind."""
        names = np.array(self._names())
        reliefs = []
        for name in dict.fromkeys(names.tolist()):
            mask = names == name
            outcome = self._polish(self._space.point(found.choice), mask)
            excesses = outcome.values.excesses
            met = excesses[~mask].max(initial=-1.0) <= _MET
            factor = float(np.exp(max(excesses[mask].max(), 0.0))) if met else np.nan
            reliefs.append(Concession(name, factor))
        return tuple(reliefs)

    def _improve(self, starts: Iterable[FloatArray], progress: Progress) -> Searched:
        outcomes: list[Polished] = []
        for n, start in enumerate(starts):
            outcomes.append(self._from(start))
            progress("tune", 0.7 * (n + 1) / (n + 2))
            if n + 1 >= _LEAST_STARTS and _agree(outcomes) and not self._space.crowded:
                break
        best = min(outcomes, key=_rank)
        if not _agree(outcomes):
            best = self._settled(best)
        if not best.values.feasible:
            best = self._nearest(best)
            best = self._again(best) if best.values.feasible else best
        rounds: list[Round] = []
        for n in range(_ROUNDS):
            best = self._again(best) if n > 0 else best
            choice = self._space.choice(best.point)
            worst, more = self._required.grow(choice.gains)
            _, slower = self._judge.grow(choice, (*self._weights, *self._kept))
            largest = max(one.excess for one in worst)
            plants = self._required.plants + self._judge.plants
            cost = self._evaluate(best.point).cost
            rounds.append(Round(cost, float(np.exp(largest)), plants))
            if not (more or slower):
                break
        feasible = best.values.feasible and largest <= _MET
        if not feasible:
            best = self._nearest(best)
            worst = self._required.worst(self._space.choice(best.point).gains)
            feasible = max(one.excess for one in worst) <= _MET
        progress("tune", 1.0)
        return Searched(
            choice=self._space.choice(best.point),
            feasible=feasible,
            converged=best.converged,
            worst=worst,
            binding=self._binding(best),
            rounds=tuple(rounds),
            evaluations=self._evaluations,
        )

    def _again(self, best: Polished) -> Polished:
        """Return a point polished once more, plants having been added."""
        if not best.values.feasible:
            return self._nearest(best)
        return self._settled(self._polish(best.point))

    def _nearest(self, best: Polished) -> Polished:
        """Return the point nearest to every requirement, whatever the objective."""
        return self._polish(best.point, np.ones(len(best.values.excesses), np.bool_))

    def _starts(self, first: Choice | None) -> Iterable[FloatArray]:
        if first is not None:
            return [self._space.point(first)]
        kind = max(self._weights, key=lambda kind: self._weights[kind])
        return chain(
            first_points(self._model, self._space, self._start, kind),
            screened(self._space, self._merit),
        )

    def _merit(self, point: FloatArray) -> float:
        """Return how good a start looks: its cost, and above all what it breaks."""
        values = self._evaluate(point)
        broken = max(float(values.excesses.max(initial=-1.0)), 0.0)
        return float(np.log(max(values.cost, 1e-300))) + _BROKEN * broken

    def _from(self, start: FloatArray) -> Polished:
        """Return the outcome from a start, going by the nearest requirements where it must."""
        found = self._polish(start)
        if found.values.feasible:
            return found
        nearest = self._nearest(found)
        return self._polish(nearest.point) if nearest.values.feasible else nearest

    def _settled(self, best: Polished) -> Polished:
        """Return the outcome of polishing until polishing again brings nothing."""
        for _ in range(_REPEATS):
            again = self._polish(best.point)
            better = again.values.cost < (1 - _GAINED) * best.values.cost
            if _rank(again) < _rank(best):
                best = again
            if not better:
                return replace(best, converged=best.converged or again.converged)
        return best

    def _polish(self, start: FloatArray, relieved: np.ndarray | None = None) -> Polished:
        evaluate = self._evaluate if relieved is None else self._evaluate_requirements
        found = polish(evaluate, start, self._space.low, self._space.high, relieved)
        self._evaluations += found.evaluations
        return found

    def _evaluate(self, point: FloatArray) -> Values:
        choice = self._space.choice(point)
        peaks = np.zeros(0)
        if "tracking" in self._weights:
            share = self._weights["tracking"] / self._base("tracking")
            peaks = share * self._judge.tracking_peaks(choice).ravel()
        smooth = sum(
            weight * self._value(choice, kind) / self._base(kind)
            for kind, weight in self._weights.items()
            if kind != "tracking"
        )
        return Values(peaks, float(smooth), self._excesses(choice))

    def _evaluate_requirements(self, point: FloatArray) -> Values:
        return Values(np.zeros(0), 0.0, self._excesses(self._space.choice(point)))

    def _excesses(self, choice: Choice) -> FloatArray:
        """Return the requirements' excesses, and those of earlier objectives."""
        kept = [
            np.log(self._values(choice, kind).ravel() / most) for kind, most in self._kept.items()
        ]
        return np.concatenate([self._required.of(choice.gains), *kept])

    def _names(self) -> list[str]:
        """Return the name behind each excess."""
        names = [*self._required.names]
        for kind in self._kept:
            count = np.size(self._values(self._space.choice(self._space.low), kind))
            names += [f"objective {kind}"] * count
        return names

    def _values(self, choice: Choice, kind: str) -> FloatArray:
        """Return what is to be small of one kind of objective."""
        if kind == "tracking":
            return self._judge.tracking_peaks(choice)
        if kind == "load-step":
            return self._judge.load_peaks(choice.gains)
        if kind == "disturbance":
            return np.array([1 / max(choice.gains.k_i_pos, _NO_INTEGRAL)])
        return np.array([1 / self._judge.bandwidth(choice.gains)])

    def _value(self, choice: Choice, kind: str) -> float:
        return float(self._values(choice, kind).max())

    def _base(self, kind: str) -> float:
        """Return the study's own gains' value of one kind of objective; 1 where they have none."""
        before = self._before
        value = {
            "tracking": before.tracking,
            "disturbance": 1 / (before.integral_gain or 1.0),
            "load-step": before.load_step,
            "bandwidth": 1 / before.bandwidth,
        }[kind]
        return value if np.isfinite(value) and value > 0 else 1.0

    def _binding(self, best: Polished) -> tuple[str, ...]:
        """Return the requirements and bounds that a point lies at."""
        names = np.array(self._names())
        at = names[best.values.excesses > -_BINDING].tolist()
        space = self._space
        for name, value, low, high in zip(
            space.names, best.point, space.low, space.high, strict=True
        ):
            if value - low < 1e-4:
                at.append(f"{name} ≥")
            if high - value < 1e-4:
                at.append(f"{name} ≤")
        return tuple(dict.fromkeys(at))


def _agree(outcomes: list[Polished]) -> bool:
    """Return whether the best two outcomes are equally good: more starts would find no better."""
    if len(outcomes) < 2:
        return False
    first, second = sorted(outcomes, key=_rank)[:2]
    near = second.values.cost - first.values.cost <= _SAME * abs(first.values.cost)
    return first.values.feasible and second.values.feasible and near


def _rank(outcome: Polished) -> tuple[float, float]:
    """Return what makes one outcome better than another: requirements first."""
    over = float(outcome.values.excesses.max(initial=-1.0))
    return (0.0 if outcome.values.feasible else over, outcome.values.cost)
