"""One convex step: a second-order cone program over a padded set of rows, built once per shape.

With δ the scaled change of the parameters, each row says

    |left·δ + left_0| ≤ right·δ + right_0 − γ·weight + σ·slack

with ``left`` complex. Rows come and go as frequencies do; the program keeps its shape, and unused
rows say 0 ≤ 1, so that cvxpy compiles it once.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from mptune.arrays import ComplexArray, FloatArray

_RADIUS = 10.0  # of the box that keeps δ bounded while few rows are known
_GAMMA_MOST = 10.0  # γ is relative to its present value


@dataclass(frozen=True)
class ConeRows:
    """R rows of a step; K parameters."""

    right: FloatArray  # (R, K)
    right_0: FloatArray  # (R,)
    left: ComplexArray  # (R, K)
    left_0: ComplexArray  # (R,)
    weight: FloatArray  # (R,)
    slack: FloatArray  # (R,)

    def __len__(self) -> int:
        """Return R."""
        return len(self.right_0)

    @classmethod
    def joined(cls, parts: list[ConeRows]) -> ConeRows:
        """Return several sets of rows as one."""
        names = [entry.name for entry in fields(cls)]
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


@dataclass(frozen=True)
class Fixed:
    """What is there at every frequency's choice: J norms |R δ + r| ≤ 1 + σ·slack, M linear rows."""

    norms: tuple[tuple[FloatArray, FloatArray, float], ...]  # R (r, K), r (r,), slack
    linear: FloatArray  # (M, K)
    linear_0: FloatArray  # (M,): linear·δ ≤ linear_0 + σ·slack
    linear_slack: FloatArray  # (M,)


@dataclass(frozen=True)
class Step:
    """The solution of one program: δ ``(K,)``, or None where the solver found none."""

    delta: FloatArray | None
    slack: float
    gamma: float


def solve_step(
    rows: ConeRows, fixed: Fixed, gain: FloatArray, gamma_gain: float, slack_low: float
) -> Step:
    """Return the δ that makes gain·δ + gamma_gain·γ − σ largest, σ ≥ slack_low."""
    capacity = 32
    while capacity < len(rows):
        capacity *= 2
    shapes = tuple(matrix.shape[0] for matrix, _, _ in fixed.norms)
    program = _program(len(gain), capacity, shapes, len(fixed.linear_0))
    return program.solve(rows, fixed, gain, gamma_gain, slack_low)


@lru_cache(maxsize=16)
def _program(count: int, capacity: int, norms: tuple[int, ...], linear: int) -> _Program:
    return _Program(count, capacity, norms, linear)


class _Program:
    """The parametrised cvxpy problem of one shape."""

    def __init__(self, count: int, capacity: int, norms: tuple[int, ...], linear: int) -> None:
        import cvxpy

        cp: Any = cvxpy  # its annotations are incomplete

        def table(*shape: int) -> Any:
            return cp.Parameter(shape, value=np.zeros(shape))

        self._capacity, self._failure = capacity, cp.SolverError
        self._delta, self._gamma, self._sigma = cp.Variable(count), cp.Variable(), cp.Variable()
        delta, gamma, sigma = self._delta, self._gamma, self._sigma
        self._right, self._right_0 = table(capacity, count), table(capacity)
        self._left, self._left_0 = table(2 * capacity, count), table(2 * capacity)
        self._weight, self._slack = table(capacity), table(capacity)
        self._norms = [(table(size, count), table(size), table(1)) for size in norms]
        self._linear = (table(max(linear, 1), count), table(max(linear, 1)), table(max(linear, 1)))
        self._gain, self._gamma_gain = table(count), cp.Parameter(value=0.0)
        self._slack_low = cp.Parameter(value=0.0)
        right = self._right @ delta + self._right_0 - self._weight * gamma + self._slack * sigma
        left = cp.reshape(self._left @ delta + self._left_0, (2, capacity), order="C")
        matrix, constant, slack = self._linear
        constraints = [
            cp.SOC(right, left, axis=0),
            matrix @ delta <= constant + slack * sigma,
            sigma >= self._slack_low,
            gamma >= 0,
            gamma <= _GAMMA_MOST,
            cp.abs(delta) <= _RADIUS,
        ]
        for root, root_0, relief in self._norms:
            constraints.append(cp.SOC((1 + relief * sigma)[0], root @ delta + root_0))
        objective = cp.Maximize(self._gain @ delta + self._gamma_gain * gamma - sigma)
        self._problem = cp.Problem(objective, constraints)

    def solve(
        self, rows: ConeRows, fixed: Fixed, gain: FloatArray, gamma_gain: float, slack_low: float
    ) -> Step:
        used, capacity = len(rows), self._capacity
        self._right.value = _padded(rows.right, capacity)
        self._right_0.value = np.concatenate([rows.right_0, np.ones(capacity - used)])
        left, left_0 = _padded(rows.left, capacity), _padded(rows.left_0, capacity)
        self._left.value = np.concatenate([left.real, left.imag])
        self._left_0.value = np.concatenate([left_0.real, left_0.imag])
        self._weight.value = _padded(rows.weight, capacity)
        self._slack.value = _padded(rows.slack, capacity)
        for (root, root_0, relief), values in zip(self._norms, fixed.norms, strict=True):
            root.value, root_0.value, relief.value = values[0], values[1], np.array([values[2]])
        if len(fixed.linear_0):
            for parameter, value in zip(
                self._linear, (fixed.linear, fixed.linear_0, fixed.linear_slack), strict=True
            ):
                parameter.value = value
        self._gain.value, self._gamma_gain.value = gain, gamma_gain
        self._slack_low.value = slack_low
        try:
            with warnings.catch_warnings():  # a step that is inaccurate is found out by the caller
                warnings.simplefilter("ignore", UserWarning)
                self._problem.solve(solver="CLARABEL")
        except self._failure:
            return Step(None, np.inf, 0.0)
        if self._delta.value is None:
            return Step(None, np.inf, 0.0)
        delta = np.asarray(self._delta.value, np.float64)
        return Step(delta, float(self._sigma.value), float(self._gamma.value))


def _padded(values: Any, capacity: int) -> Any:
    empty = np.zeros((capacity - len(values), *values.shape[1:]), values.dtype)
    return np.concatenate([values, empty])
