"""Loop shaping: tune on the few plants that bind, verify on all, and say what stands in the way."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from itertools import chain, islice
from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.arrays import FloatArray, frozen
from mptune.shape.active_plants import ActivePlants
from mptune.shape.problem import Linear, Maximise, Norm, Peak
from mptune.shape.procedure import Iterate, Procedure, ShapeStatus, Use
from mptune.shape.starts import integral_starts, stabilising_starts
from mptune.strict import strict
from mptune.summary import Summarised

if TYPE_CHECKING:
    from mptune.shape.problem import Problem

_ROUNDS = 30
_STARTS = 3  # of each kind, before a problem is called infeasible
_EXACT = 1e-6  # of a quotient
_EQUAL = 1e-3  # at the least largest quotient several are equally large
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


@dataclass(frozen=True, repr=False)
class Shaped(Summarised):
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

    status: ShapeStatus
    parameters: FloatArray
    objective: float
    uses: tuple[Use, ...]
    stable: bool
    iterates: tuple[Iterate, ...]
    rounds: tuple[tuple[float, float], ...]
    blocking: Use | None
    reliefs: tuple[Relief, ...]
    start_replaced: bool

    @property
    def headline(self) -> str:
        """The status and the objective."""
        return f"{self.status}, objective {self.objective:.6g}"

    def json(self) -> dict[str, Any]:
        """Return status, requirements and what stands in the way; None for what is not finite."""
        return strict(
            {
                "status": self.status.value,
                "objective": self.objective,
                "stable": self.stable,
                "uses": [asdict(use) for use in self.uses],
                "blocking": asdict(self.blocking) if self.blocking else None,
                "reliefs": [asdict(relief) for relief in self.reliefs],
            }
        )


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
    attempts = []
    starts = stabilising_starts(problem, given), integral_starts(problem)
    for first in chain.from_iterable(islice(one, _STARTS) for one in starts):
        replaced = given is not None and not np.array_equal(first, given)
        attempt = _Shaping(problem, first, replaced=replaced)
        outcome = attempt.shaped()
        if outcome.status is not ShapeStatus.INFEASIBLE:
            return outcome
        attempts.append((outcome, attempt))
    if not attempts:
        return _nothing(problem, given)
    outcome, attempt = min(attempts, key=lambda pair: max(use.quotient for use in pair[0].uses))
    return replace(outcome, reliefs=attempt.reliefs())


class _Shaping:
    """One problem from one start."""

    def __init__(self, problem: Problem, start: FloatArray, *, replaced: bool) -> None:
        self._problem, self._start, self._replaced = problem, start, replaced
        self._active = ActivePlants(problem, start)
        self._rounds: list[tuple[float, float]] = []

    def shaped(self) -> Shaped:
        """Return the outcome."""
        x = self._start
        converged = False
        iterates: tuple[Iterate, ...] = ()
        for _ in range(_ROUNDS):
            procedure = Procedure(self._problem, self._active.curves(), x)
            x = procedure.satisfy(x, self._problem.names)
            if procedure.largest(x) > 1 + _EXACT:
                return self._outcome(ShapeStatus.INFEASIBLE, x, procedure, ())
            iterates, converged = procedure.optimise(x)
            x, reached = iterates[-1].parameters, iterates[-1].objective
            uses = self._uses(x, procedure)
            self._rounds.append((reached, max(use.quotient for use in uses)))
            if not self._active.add(x, 1 + _EXACT, (1 + _NEAR) * reached):
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
            return self._outcome(ShapeStatus.INFEASIBLE, x, procedure, iterates[:last])
        optimal = converged and last == len(iterates)
        status = ShapeStatus.OPTIMAL if optimal else ShapeStatus.NOT_CONVERGED
        return self._outcome(status, x, procedure, iterates[:last])

    def reliefs(self) -> tuple[Relief, ...]:
        """Return how far each requirement would have to give, judged on the plants picked."""
        problem, found = self._problem, []
        for name in sorted(problem.names):
            if not _adjustable(problem, name):
                continue
            curves, others = self._active.curves(), problem.without(name)
            alone = Procedure(others, curves.without(name), self._start)
            x = alone.satisfy(self._start, others.names)
            factor = np.inf
            if alone.largest(x) <= 1 + _EXACT:
                procedure = Procedure(problem, curves, x)
                x = procedure.satisfy(x, {name})
                factor = procedure.largest(x, {name})
            found.append(Relief(name, factor, _bound_after(problem, name, factor)))
        return tuple(found)

    def _uses(self, x: FloatArray, procedure: Procedure) -> tuple[Use, ...]:
        """Return every requirement's largest quotient over all plants."""
        worst = self._active.worst(x)
        worst.pop("objective", None)
        return (*worst.values(), *procedure.fixed_uses(x))

    def _outcome(
        self,
        status: ShapeStatus,
        x: FloatArray,
        procedure: Procedure,
        iterates: tuple[Iterate, ...],
    ) -> Shaped:
        uses = self._uses(x, procedure)
        return Shaped(
            status=status,
            parameters=frozen(x.copy()),
            objective=procedure.objective(x),
            uses=uses,
            stable=self._problem.stable(x),
            iterates=iterates,
            rounds=tuple(self._rounds),
            blocking=_blocking(uses) if status is ShapeStatus.INFEASIBLE else None,
            reliefs=(),
            start_replaced=self._replaced,
        )


def _blocking(uses: tuple[Use, ...]) -> Use:
    """Return the largest use; of several that are equally large, one that names a frequency."""
    largest = max(use.quotient for use in uses)
    near = [use for use in uses if use.quotient >= largest * (1 - _EQUAL)]
    return max(near, key=lambda use: (np.isfinite(use.frequency), use.quotient))


def _adjustable(problem: Problem, name: str) -> bool:
    """Return whether a requirement could give: bounds at 0 cannot."""
    return all(one.name != name or one.largest != 0 for one in problem.linear)


def _bound_after(problem: Problem, name: str, factor: float) -> float:
    """Return the bound that a requirement would need, NaN where it is a curve."""
    for one in (*problem.requirements, *problem.linear):
        if one.name == name and isinstance(one, Peak | Norm | Linear) and not callable(one.largest):
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
        status=ShapeStatus.INFEASIBLE,
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
