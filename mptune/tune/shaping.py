"""Loop shaping: tune on the few plants that bind, verify on all, and say what stands in the way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import FloatArray, frozen
from mptune.tune.convex import Iterate, Procedure, Status, Use
from mptune.tune.picks import Picks
from mptune.tune.problem import Linear, Maximise
from mptune.tune.start import stabilising_starts

if TYPE_CHECKING:
    from mptune.tune.problem import Problem

_ROUNDS = 30
_STARTS = 3  # before a problem is called infeasible
_EXACT = 1e-6  # of a quotient
_NEAR = 1e-4  # of the objective: a plant that is worse by less is not picked for it


@dataclass(frozen=True)
class Relief:
    """How far one requirement would have to give if all others stay.

    Attributes
    ----------
    requirement
        Its name.
    factor
        What its bound would have to be multiplied by; infinite where the others are infeasible
        without it too.
    bound
        The bound that would do; NaN where the bound is a curve.
    """

    requirement: str
    factor: float
    bound: float


@dataclass(frozen=True)
class Shaped:
    """The outcome of a loop shaping.

    Attributes
    ----------
    status
        Optimal says first-order stationary: a local optimum, all requirements verified.
    parameters
        ``(K,)``; where infeasible, those of the smallest largest quotient.
    objective
        coefficients·x, or the largest w|S|.
    uses
        Every requirement's largest quotient of found and allowed over all plants and frequencies.
    stable
        Whether the parameters stabilise every loop.
    iterates
        The way there, the last round's.
    rounds
        Per round of picking plants: the objective on the plants picked, and the largest quotient
        over all plants.
    blocking
        The requirement with the largest quotient where infeasible.
    reliefs
        How far each requirement would have to give where infeasible.
    start_replaced
        Whether the start given did not stabilise and another was found.
    """

    status: Status
    parameters: FloatArray
    objective: float
    uses: tuple[Use, ...]
    stable: bool
    iterates: tuple[Iterate, ...]
    rounds: tuple[tuple[float, float], ...]
    blocking: Use | None
    reliefs: tuple[Relief, ...]
    start_replaced: bool


def shape_loop(problem: Problem, start: FloatArray | None = None) -> Shaped:
    """Return the parameters that are locally best within the requirements.

    Parameters
    ----------
    problem
        Loops, requirements, objective.
    start
        Parameters to start from ``(K,)``; found where None or not stabilising.

    Returns
    -------
    Shaped
        Parameters and verdict. Infeasible too is a local verdict: the largest quotient could not
        be brought to 1 from any of a few starts.
    """
    given = None if start is None else np.asarray(start, np.float64)
    starts = stabilising_starts(problem, given, _STARTS)
    if not starts:
        return _nothing(problem, given)
    replaced = given is not None and not np.array_equal(starts[0], given)
    outcomes = []
    for first in starts:
        outcome = _Shaping(problem, first, replaced=replaced).shaped()
        if outcome.status is not Status.INFEASIBLE:
            return outcome
        outcomes.append(outcome)
    return min(outcomes, key=lambda one: max(use.quotient for use in one.uses))


class _Shaping:
    """One problem from one start."""

    def __init__(self, problem: Problem, start: FloatArray, *, replaced: bool) -> None:
        self._problem, self._start, self._replaced = problem, start, replaced
        self._picks = Picks(problem, start)
        self._names = {one.name for one in (*problem.requirements, *problem.linear)}
        self._rounds: list[tuple[float, float]] = []

    def shaped(self) -> Shaped:
        """Return the outcome."""
        x = self._start
        converged = False
        iterates: tuple[Iterate, ...] = ()
        for _ in range(_ROUNDS):
            procedure = Procedure(self._problem, self._picks.board(), x)
            x = procedure.satisfy(x, self._names)
            if procedure.largest(x) > 1 + _EXACT:
                return self._infeasible(procedure, x)
            iterates, converged = procedure.optimise(x)
            x, reached = iterates[-1].parameters, iterates[-1].objective
            uses = self._uses(x, procedure)
            self._rounds.append((reached, max(use.quotient for use in uses)))
            if not self._picks.add(x, 1 + _EXACT, (1 + _NEAR) * reached):
                break
        else:
            converged = False
        return self._feasible(procedure, iterates, converged=converged)

    def _feasible(
        self, procedure: Procedure, iterates: tuple[Iterate, ...], *, converged: bool
    ) -> Shaped:
        """Return the outcome at the last iterate that stabilises every loop."""
        last = len(iterates)
        while last > 1 and not self._problem.stable(iterates[last - 1].parameters):
            last -= 1
        x = iterates[last - 1].parameters
        uses = self._uses(x, procedure)
        if any(use.quotient > 1 + _EXACT for use in uses):
            return self._outcome(Status.INFEASIBLE, x, procedure, iterates[:last])
        optimal = converged and last == len(iterates)
        status = Status.OPTIMAL if optimal else Status.NOT_CONVERGED
        return self._outcome(status, x, procedure, iterates[:last])

    def _infeasible(self, procedure: Procedure, x: FloatArray) -> Shaped:
        """Return the outcome at x, and how far each requirement would have to give."""
        reliefs = []
        for name in sorted(self._names):
            if not _adjustable(self._problem, name):
                continue
            others = self._names - {name}
            point = procedure.satisfy(self._start, others)
            factor = np.inf
            if procedure.largest(point, others) <= 1 + _EXACT:
                point = procedure.satisfy(point, {name})
                factor = procedure.largest(point, {name})
            reliefs.append(Relief(name, factor, _bound_after(self._problem, name, factor)))
        return self._outcome(Status.INFEASIBLE, x, procedure, (), tuple(reliefs))

    def _uses(self, x: FloatArray, procedure: Procedure) -> tuple[Use, ...]:
        """Return every requirement's largest quotient over all plants."""
        worst = self._picks.worst(x)
        worst.pop("objective", None)
        return (*worst.values(), *procedure.fixed_uses(x))

    def _outcome(
        self,
        status: Status,
        x: FloatArray,
        procedure: Procedure,
        iterates: tuple[Iterate, ...],
        reliefs: tuple[Relief, ...] = (),
    ) -> Shaped:
        uses = self._uses(x, procedure)
        infeasible = status is Status.INFEASIBLE
        return Shaped(
            status=status,
            parameters=frozen(x.copy()),
            objective=procedure.objective(x),
            uses=uses,
            stable=self._problem.stable(x),
            iterates=iterates,
            rounds=tuple(self._rounds),
            blocking=max(uses, key=lambda use: use.quotient) if infeasible else None,
            reliefs=reliefs,
            start_replaced=self._replaced,
        )


def _adjustable(problem: Problem, name: str) -> bool:
    """Return whether a requirement could give: bounds at 0 cannot."""
    return all(one.name != name or one.largest != 0 for one in problem.linear)


def _bound_after(problem: Problem, name: str, factor: float) -> float:
    """Return the bound that a requirement would need, NaN where it is a curve."""
    for one in (*problem.requirements, *problem.linear):
        if one.name == name and not callable(one.largest):
            return (
                one.largest * factor
                if not isinstance(one, Linear)
                else (one.largest + (factor - 1) * abs(one.largest))
            )
    return np.nan


def _nothing(problem: Problem, given: FloatArray | None) -> Shaped:
    """Return the outcome where no parameters that stabilise were found."""
    count = len(problem.structure.names)
    x = np.zeros(count) if given is None else given
    use = Use("stability", np.inf, np.nan, -1)
    return Shaped(
        status=Status.INFEASIBLE,
        parameters=frozen(x.copy()),
        objective=float(problem.objective.coefficients @ x)
        if isinstance(problem.objective, Maximise)
        else np.inf,
        uses=(use,),
        stable=False,
        iterates=(),
        rounds=(),
        blocking=use,
        reliefs=(),
        start_replaced=False,
    )
