"""The search of one structure's best gains: convex starts, polish, growing sets of plants."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from mptune.progress import silent
from mptune.tune.excesses import Excesses
from mptune.tune.polish import ITERATIONS, Polished, polish
from mptune.tune.result import Concession, Round
from mptune.tune.space import Choice, Space, space_of
from mptune.tune.starts import first_points, screened
from mptune.tune.worth import Worth

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from mptune.arrays import FloatArray
    from mptune.params.section import Range
    from mptune.progress import Progress
    from mptune.robust.model import LinearModel
    from mptune.tune.excess import Excess
    from mptune.tune.objective import Figures, Judge

_ROUNDS = 8
_REPEATS, _GAINED = 6, 1e-3  # of a polish, and what makes another one worth its while
_SAME = 1e-4  # of the objective: two starts that end so near have found the same optimum
_LEAST_STARTS = 5  # before two that agree are believed
_AGREED = 3  # starts that end as far from the requirements, and none nearer: then no more are tried
_BROKEN = 20.0  # weight of a broken requirement, as a logarithm, beside the cost's
_BINDING = 2e-3  # of a logarithm
_MET = 1e-5  # an excess that counts as none


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
    iterations
        Of one polish, at most.
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
        iterations: int = ITERATIONS,
    ) -> None:
        self._model, self._judge, self._before = model, judge, before
        self._iterations = iterations
        self._space = space_of(model, largest_velocity_gain, structure, extra)
        own = model.gains.k_p_vel if self._space.crowded else largest_velocity_gain
        self._start = model.gains._replace(k_p_vel=min(own, largest_velocity_gain))
        self._required = Excesses(model, self._start, hand)
        self._worth = Worth(model, judge, before, self._space, self._required, hand)
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
            self._worth.turn_to(kind, found.choice, objective.keep)
            better = self._improve([self._space.point(found.choice)], progress)
            found = better if better.feasible else found
        return found

    def reliefs(self, found: Searched) -> tuple[Concession, ...]:
        """Return how far each requirement would have to give, on the plants that bind."""
        names = np.array(self._worth.names())
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
            outcomes.append(self._from(start, blocked=n > 0 and not _any_feasible(outcomes)))
            progress("tune", 0.7 * (n + 1) / (n + 2))
            alone = not self._space.crowded
            settled = _agree(outcomes) and (alone or self._model.estimated)
            if n + 1 >= _LEAST_STARTS and (settled or _agree_on_none(outcomes)):
                break
        best = min(outcomes, key=_rank)
        if not _agree(outcomes):
            best = self._settled(best)
        if not best.values.feasible:
            best = self._nearest(best.point)
            best = self._again(best) if best.values.feasible else best
        rounds: list[Round] = []
        for n in range(_ROUNDS):
            best = self._again(best) if n > 0 else best
            choice = self._space.choice(best.point)
            by = choice.put_over(self._model).filters
            worst, more = self._required.grow(choice.gains, by)
            asked, slower = self._judge.grow(choice, self._worth.kinds)
            worst += self._worth.bounded(asked)
            largest = max((one.excess for one in worst), default=-np.inf)
            plants = self._required.plants + self._judge.plants
            cost = self._worth.of(best.point).cost
            rounds.append(Round(cost, float(np.exp(largest)), plants))
            if not (more or slower):
                break
        feasible = best.values.feasible and largest <= _MET
        if not feasible:
            best = self._nearest(best.point)
            choice = self._space.choice(best.point)
            asked = self._judge.grow(choice, self._worth.kinds)[0]
            by = choice.put_over(self._model).filters
            worst = (*self._required.worst(choice.gains, by), *self._worth.bounded(asked))
            feasible = all(one.excess <= _MET for one in worst)
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
            return self._nearest(best.point)
        return self._settled(self._polish(best.point))

    def _nearest(self, start: FloatArray) -> Polished:
        """Return the point nearest to every requirement, whatever the objective."""
        count = len(self._worth.names())  # plants may have been added since the point was found
        return self._polish(start, np.ones(count, np.bool_))

    def _starts(self, first: Choice | None) -> Iterable[FloatArray]:
        if first is not None:
            return [self._space.point(first)]
        return chain(
            first_points(self._model, self._space, self._start, self._worth.heaviest),
            screened(self._space, self._merit),
        )

    def _merit(self, point: FloatArray) -> float:
        """Return how good a start looks: its cost, and above all what it breaks."""
        values = self._worth.of(point)
        broken = max(float(values.excesses.max(initial=-1.0)), 0.0)
        return float(np.log(max(values.cost, 1e-300))) + _BROKEN * broken

    def _from(self, start: FloatArray, *, blocked: bool) -> Polished:
        """Return the outcome from a start, going by the nearest requirements where it must.

        Where no start before it came to keep them, the objective waits until they are kept.
        """
        if not blocked:
            found = self._polish(start)
            if found.values.feasible:
                return found
            start = found.point
        nearest = self._nearest(start)
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
        evaluate = self._worth.of if relieved is None else self._worth.of_requirements
        low, high = self._space.low, self._space.high
        found = polish(evaluate, start, low, high, relieved, self._iterations)
        self._evaluations += found.evaluations
        return found

    def _binding(self, best: Polished) -> tuple[str, ...]:
        """Return the requirements and bounds that a point lies at."""
        names = np.array(self._worth.names())
        at = names[self._worth.of_requirements(best.point).excesses > -_BINDING].tolist()
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


def _any_feasible(outcomes: list[Polished]) -> bool:
    return any(one.values.feasible for one in outcomes)


def _agree_on_none(outcomes: list[Polished]) -> bool:
    """Return whether no outcome keeps the requirements and the nearest are equally far from it.

    More starts would hardly come nearer: that they cannot be kept is as good as a local search can
    say, and errs towards infeasible.
    """
    if _any_feasible(outcomes) or len(outcomes) < _AGREED:
        return False
    over = sorted(_rank(one)[0] for one in outcomes)
    return over[_AGREED - 1] - over[0] <= _SAME


def _rank(outcome: Polished) -> tuple[float, float]:
    """Return what makes one outcome better than another: requirements first."""
    over = float(outcome.values.excesses.max(initial=-1.0))
    return (0.0 if outcome.values.feasible else over, outcome.values.cost)
