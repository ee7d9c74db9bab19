"""The convex-concave procedure: parameters of a linear controller, one convex step after another.

The requirements ask that |left| ≤ |1 + L| with both sides affine in the parameters. The right side
is replaced by Re(ū (1 + L)) ≤ |1 + L| with u = (1 + L)/|1 + L| at the last iterate, which leaves a
second-order cone program whose every solution keeps the true requirement (Hast, Åström,
Bernhardsson, Boyd 2013; Boyd, Hast, Åström 2016). The optimum found is a local one: first-order
stationary.

Each program holds the few frequencies that matter and is solved again with those that its solution
violates, on a grid that is refined about every peak, until none is left: the verdict is always the
whole grid's. No loop meets −1 on the straight way between two iterates, since Re(ū (1 + L)) > 0
along it: the number of encirclements is kept.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from mptune.shape.curves import IN_HAND, Curves
from mptune.shape.problem import Maximise
from mptune.shape.step import ConeRows, Fixed, solve_step

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.shape.curves import Key
    from mptune.shape.problem import Problem

_STEPS = 60
_EXCHANGES = 25
_TOLERANCE = 2e-5  # of the objective: what further steps would still bring
_VIOLATION = 0.5 * IN_HAND
_NOTHING = 1e-300
_ROUNDING = 1e-6  # of a parameter's scale
_SLACK_LOW = -0.01  # how far inside the requirements the feasibility phase aims


class ShapeStatus(StrEnum):
    """How a tuning ended."""

    OPTIMAL = "optimal"  # first-order stationary: a local optimum
    NOT_CONVERGED = "feasible, not converged"
    INFEASIBLE = "infeasible"
    UNPROVEN = "not proven"  # kept at the frequencies looked at, without a certificate that holds


@dataclass(frozen=True)
class Use:
    """The largest quotient of found and allowed of one requirement.

    Attributes
    ----------
    requirement
        Its name.
    quotient
        At most 1 where it is kept.
    frequency
        Where [rad/s]; NaN for requirements without frequency.
    plant
        Row of the loops; −1 for requirements without plant.
    """

    requirement: str
    quotient: float
    frequency: float
    plant: int


@dataclass(frozen=True)
class Iterate:
    """One iterate: parameters, objective, and the largest quotient over the requirements."""

    parameters: FloatArray
    objective: float
    use: float


class Procedure:
    """The convex-concave procedure on the loops of one curves."""

    def __init__(self, problem: Problem, curves: Curves, start: FloatArray) -> None:
        self._problem, self._curves = problem, curves
        self._matrices = [(norm.name, norm.matrix(problem.structure)) for norm in problem.norms]
        self._linear = problem.linear
        self._scale = _scale(problem, start)
        self._keys: set[Key] = set()
        self._linear_size = [
            abs(one.largest) or float(np.abs(one.coefficients) @ self._scale)
            for one in self._linear
        ]

    def uses(self, x: FloatArray) -> tuple[Use, ...]:
        """Return every requirement's largest quotient at x over the curves, peaks refined."""
        self._curves.refine(x)
        worst = self._curves.worst(x)
        worst.pop("objective", None)
        return tuple(Use(kind, *values) for kind, values in worst.items()) + self.fixed_uses(x)

    def fixed_uses(self, x: FloatArray) -> tuple[Use, ...]:
        """Return the quotients of norms and linear requirements, which know no plant."""
        found = []
        for name, matrix in self._matrices:
            size = float(np.linalg.norm(matrix @ np.append(x, 1.0)))
            found.append(Use(name, size, np.nan, -1))
        for one, size in zip(self._linear, self._linear_size, strict=True):
            over = (float(one.coefficients @ x) - one.largest) / size
            found.append(Use(one.name, 1 + over, np.nan, -1))
        for cone in self._problem.cones:
            quotient = abs(cone.left @ x) / max(float(cone.right @ x), _NOTHING)
            found.append(Use(cone.name, float(quotient), np.nan, -1))
        for curved in self._problem.concave:
            over = curved.value(x) / max(curved.size(x), _NOTHING)
            found.append(Use(curved.name, 1 + over, np.nan, -1))
        return tuple(found)

    def largest(self, x: FloatArray, names: set[str] | None = None) -> float:
        """Return the largest quotient at x, of the named requirements only where given."""
        return max(
            (use.quotient for use in self.uses(x) if names is None or use.requirement in names),
            default=0.0,
        )

    def objective(self, x: FloatArray) -> float:
        """Return the objective: coefficients·x, or max w|S| where that is to be small."""
        if isinstance(self._problem.objective, Maximise):
            return float(self._problem.objective.coefficients @ x)
        return self._curves.worst(x)["objective"][0]

    def merit(self, x: FloatArray) -> float:
        """Return the objective with the sign that makes more better."""
        value = self.objective(x)
        return value if isinstance(self._problem.objective, Maximise) else -value

    def optimise(self, x: FloatArray) -> tuple[tuple[Iterate, ...], bool]:
        """Return the iterates from a feasible x, and whether they converged."""
        iterates = [self._iterate(x)]
        before = np.inf
        for _ in range(_STEPS):
            y = self._step(x, {})
            if y is None:
                return tuple(iterates), False
            gained = (self.merit(y) - self.merit(x)) / max(abs(self.merit(y)), 1e-12)
            if gained <= 0:
                return tuple(iterates), True
            x = y
            iterates.append(self._iterate(x))
            rate = min(gained / before, 0.95) if np.isfinite(before) else 0.95
            if gained * rate / (1 - rate) < _TOLERANCE:
                return tuple(iterates), True
            before = gained
        return tuple(iterates), False

    def satisfy(self, x: FloatArray, names: set[str]) -> FloatArray:
        """Return x with the largest quotient of the named requirements made small, up to below 1.

        The other requirements are kept.
        """
        relief = dict.fromkeys(names, 1.0)
        present = self.largest(x, names)
        for _ in range(_STEPS):
            if present <= 1:
                return x
            y = self._step(x, relief)
            if y is None:
                return x
            reached = self.largest(y, names)
            if present - reached <= 1e-5 * present:
                return y if reached < present else x
            x, present = y, reached
        return x

    def _iterate(self, x: FloatArray) -> Iterate:
        return Iterate(x, self.objective(x), self.largest(x))

    def _fixed(self, x: FloatArray, relief: dict[str, float]) -> Fixed:
        norms = []
        for name, matrix in self._matrices:
            inner = matrix * (1 + IN_HAND)
            part = inner[:, :-1]
            norms.append((part * self._scale, part @ x + inner[:, -1], relief.get(name, 0.0)))
        linear, room, slack = [], [], []
        for one, size in zip(self._linear, self._linear_size, strict=True):
            linear.append(one.coefficients * self._scale / size)
            room.append((one.largest - float(one.coefficients @ x)) / size)
            slack.append(relief.get(one.name, 0.0))
        for curved in self._problem.concave:
            scale = max(curved.size(x), _NOTHING)
            linear.append(curved.gradient(x) * self._scale / scale)
            room.append(-curved.value(x) / scale)
            slack.append(relief.get(curved.name, 0.0))
        table = np.array(linear).reshape(len(linear), len(x))
        return Fixed(tuple(norms), table, np.array(room), np.array(slack))

    def _cones(self, x: FloatArray, relief: dict[str, float]) -> list[ConeRows]:
        """Return the cones as rows of a step from x."""
        found = []
        for cone in self._problem.cones:
            size = max(float(cone.right @ x), _NOTHING)
            right = (cone.right * self._scale / size)[None]
            left = (cone.left * self._scale / size)[None] * (1 + IN_HAND)
            left_0 = np.array([cone.left @ x], np.complex128) / size * (1 + IN_HAND)
            slack = np.array([relief.get(cone.name, 0.0)])
            right_0 = np.array([cone.right @ x]) / size
            found.append(ConeRows(right, right_0, left, left_0, np.zeros(1), slack))
        return found

    def _step(self, x: FloatArray, relief: dict[str, float]) -> FloatArray | None:
        """Return the next iterate from x; with relief, one of smaller violation."""
        curves, fixed, cones = self._curves, self._fixed(x, relief), self._cones(x, relief)
        value = self.objective(x)
        gain, gamma_gain, unit = np.zeros(len(x)), 0.0, 1.0
        if isinstance(self._problem.objective, Maximise):
            gain = self._problem.objective.coefficients * self._scale
            gain = gain / np.linalg.norm(gain)
        else:
            gamma_gain, unit = 1.0, value  # γ is relative to 1/max w|S| at x
        if relief:
            gain, gamma_gain = 0 * gain, 0.0
        keys = self._keys | curves.highest(x, 0.8)
        y = None
        for _ in range(_EXCHANGES):
            rows = ConeRows.joined([curves.rows(x, self._scale, keys, relief), *cones])
            rows.weight[:] /= unit
            step = solve_step(rows, fixed, gain, gamma_gain, _SLACK_LOW if relief else 0.0)
            if step.delta is None:
                return None
            y = self._on_bounds(x + self._scale * step.delta)
            curves.refine(y)
            gamma = step.gamma / unit if gamma_gain else 0.0
            new = curves.violated(x, y, gamma, step.slack, relief, _VIOLATION) - keys
            if not new:
                break
            keys |= new
        self._keys = {key for key in keys if key.kind != "guard"} if len(keys) < 60 else set()
        return self._safeguarded(x, y, relief)

    def _on_bounds(self, y: FloatArray) -> FloatArray:
        """Return y with what the solver's tolerance left beyond a bound put on the bound."""
        structure = self._problem.structure
        clipped = np.clip(y, structure.low, structure.high)
        return np.where(np.abs(clipped - y) <= _ROUNDING * self._scale, clipped, y)

    def _safeguarded(
        self, x: FloatArray, y: FloatArray | None, relief: dict[str, float]
    ) -> FloatArray | None:
        """Return y, drawn back to x until it truly is better, or drawn on while it still is."""
        if y is None:
            return None
        others = {use.requirement for use in self.uses(x)} - set(relief)
        present = self.largest(x, set(relief)) if relief else 0.0
        kept = max(self.largest(x, others), 1.0) + 1e-9

        def better(trial: FloatArray, than: FloatArray) -> bool:
            if not self._curves.keeps_turning(x, trial) or self.largest(trial, others) > kept:
                return False
            if relief:
                return self.largest(trial, set(relief)) < self.largest(than, set(relief))
            return self.merit(trial) > self.merit(than)

        for _ in range(12):
            if better(y, x):
                break
            y = 0.5 * (x + y)
        else:
            return x
        if relief and present <= 1:
            return y
        reach = 2.0
        best = y
        while reach < 100:
            further = self._on_bounds(x + reach * (y - x))
            if not better(further, best):
                break
            best, reach = further, 2 * reach
        return best


def _scale(problem: Problem, start: FloatArray) -> FloatArray:
    """Return the change of each parameter that moves some loop by 1 where |L| is about 1."""
    scale = np.zeros(len(start))
    for loops in problem.loops.values():
        basis = problem.structure.response(loops.omega)
        gain = np.abs(loops.gain(start @ basis)).max(axis=0)
        near = int(np.argmin(np.abs(np.log(np.maximum(gain, 1e-300)))))
        reach = np.abs(loops.plant[:, near]).max() * np.abs(basis[:, near])
        scale = np.maximum(scale, reach)
    return np.asarray(1 / np.maximum(scale, 1e-300))
