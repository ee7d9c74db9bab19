"""A loop-shaping problem as data: loops, requirements, objective.

Every loop is L_n(jω) = fixed_n + plant_n·C with C linear in the parameters x, so that L is affine
in x at each frequency. Requirements bound |S|, |T| or |C S| by curves, norms of affine
functions of C, and linear functions of x. Shapes use K for parameters.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import ComplexArray, FloatArray, IntArray
from mptune.errors import Fault, InputError
from mptune.shape.cones import Concave, Cone
from mptune.summary import Summarised

if TYPE_CHECKING:
    from mptune.shape.structure import Structure

_RESERVED = ("objective", "guard", "stability")

Between = Callable[[FloatArray, IntArray], tuple[ComplexArray, ComplexArray]]
"""Plants and fixed parts ``(n, f)`` of some rows at other frequencies."""

Curve = float | Callable[[FloatArray], FloatArray]
"""A bound over frequency: a number, or a function of ω ``(F,)`` [rad/s]."""


@dataclass(frozen=True)
class Loops:
    """N loop gains on a grid, L_n = fixed_n + plant_n·C.

    Attributes
    ----------
    omega
        ``(F,)`` rising frequencies [rad/s].
    plant, fixed
        ``(N, F)`` each.
    between
        The same at any frequency. Where None, as for measured responses, verdicts hold on the grid
        only, which is optimistic: peaks between its points are not seen.
    """

    omega: FloatArray
    plant: ComplexArray
    fixed: ComplexArray
    between: Between | None = None

    @classmethod
    def of(cls, omega: FloatArray, plant: ComplexArray, between: Between | None = None) -> Loops:
        """Return loops without a fixed part, plants ``(N, F)`` or one plant ``(F,)``."""
        rows = np.atleast_2d(np.asarray(plant, np.complex128))
        return cls(np.asarray(omega, np.float64), rows, np.zeros_like(rows), between)

    def __len__(self) -> int:
        """Return N."""
        return len(self.plant)

    def picked(self, rows: IntArray) -> Loops:
        """Return some of the loops."""
        found = replace(self, plant=self.plant[rows], fixed=self.fixed[rows])
        between = self.between
        if between is None:
            return found
        return replace(found, between=lambda omega, which: between(omega, rows[which]))

    def refined(self, added: FloatArray) -> Loops:
        """Return the loops with frequencies added to the grid."""
        if self.between is None or not len(added):
            return self
        plant, fixed = self.between(added, np.arange(len(self)))
        place = np.searchsorted(self.omega, added)
        return replace(
            self,
            omega=np.insert(self.omega, place, added),
            plant=np.insert(self.plant, place, plant, axis=1),
            fixed=np.insert(self.fixed, place, fixed, axis=1),
        )

    def gain(self, controller: ComplexArray) -> ComplexArray:
        """Return L ``(N, F)`` for C ``(F,)``."""
        return np.asarray(self.fixed + self.plant * controller)


class Function(StrEnum):
    """Which closed-loop function a requirement bounds."""

    SENSITIVITY = "|1/(1 + L)|"
    COMPLEMENTARY = "|L/(1 + L)|"
    CONTROL = "|C/(1 + L)|"


@dataclass(frozen=True)
class Peak:
    """The largest allowed size of a closed-loop function.

    Attributes
    ----------
    name
        The requirement's name in results.
    function
        S for M_S; T for M_T, and for Eq. 17 and 21, whose requirement max|Δ|·|T| ≤ allowed is a
        bound allowed/max|Δ| on |T|.
    largest
        The bound.
    loops
        The key of ``Problem.loops`` that it holds for.
    """

    name: str
    function: Function
    largest: Curve
    loops: str


@dataclass(frozen=True, repr=False)
class Norm(Summarised):
    """A bound on (Σ_f weight_f |fixed_f + slope_f·C(jω_f)|²)^½, such as a noise gain.

    Attributes
    ----------
    name
        The requirement's name in results.
    omega
        ``(F,)`` [rad/s].
    fixed, slope
        ``(F,)`` complex.
    weight
        ``(F,)``, not negative.
    largest
        The bound.
    """

    name: str
    omega: FloatArray
    fixed: ComplexArray
    slope: ComplexArray
    weight: FloatArray
    largest: float

    def matrix(self, structure: Structure) -> FloatArray:
        """Return R ``(K + 1, K + 1)`` such that the norm over its bound is |R (x, 1)|."""
        root = np.sqrt(self.weight) / self.largest
        columns = [*(structure.response(self.omega) * self.slope), self.fixed]
        complex_rows = np.stack(columns, axis=1) * root[:, None]
        rows = np.concatenate([complex_rows.real, complex_rows.imag])
        size = rows.shape[1]
        rows = np.concatenate([rows, np.zeros((size, size))])  # at least as many rows as columns
        return np.asarray(np.linalg.qr(rows, mode="r"), np.float64)


@dataclass(frozen=True)
class Linear:
    """The requirement coefficients·x ≤ largest."""

    name: str
    coefficients: FloatArray  # (K,)
    largest: float


@dataclass(frozen=True)
class Maximise:
    """The objective to make coefficients·x large, such as the integral gain."""

    coefficients: FloatArray  # (K,)


@dataclass(frozen=True)
class WeightedSensitivity:
    """The objective to make max w(ω)|S| small over some loops: a stand-in for tracking."""

    weight: Curve
    loops: str


Requirement = Peak | Norm | Linear | Cone | Concave
Objective = Maximise | WeightedSensitivity


@dataclass(frozen=True)
class Problem:
    """What to tune, within what, for what.

    Attributes
    ----------
    structure
        The controller. Its bounds are requirements too, named after its parameters.
    loops
        Loops by name. All stay as stable as they are at the start.
    objective
        What to make best.
    requirements
        The requirements.
    stable
        Whether parameters x ``(K,)`` stabilise every loop, by encirclements.
    """

    structure: Structure
    loops: dict[str, Loops]
    objective: Objective
    requirements: tuple[Requirement, ...]
    stable: Callable[[FloatArray], bool] = field(repr=False)

    def __post_init__(self) -> None:
        """Refuse names that stand for two things, and loops that are not there."""
        named = [one.name for one in (*self.requirements, *self.bounds)] + [*_RESERVED]
        for name in named:
            if named.count(name) > 1:
                fault = Fault(name, "", "names two requirements", "give each a name of its own")
                raise InputError("problem", fault)
        looked_at = [peak.loops for peak in self.peaks]
        if isinstance(self.objective, WeightedSensitivity):
            looked_at.append(self.objective.loops)
        for name in looked_at:
            if name not in self.loops:
                remedy = f"one of {', '.join(self.loops)}"
                raise InputError("problem", Fault(name, "", "are no loops of the problem", remedy))

    @property
    def names(self) -> set[str]:
        """The names of all requirements, the structure's bounds included."""
        return {one.name for one in (*self.requirements, *self.bounds)}

    def without(self, name: str) -> Problem:
        """Return the problem without one requirement, or without one bound of a parameter."""
        structure = self.structure
        low = [
            -np.inf if name == f"{one} ≥" else bound
            for one, bound in zip(structure.names, structure.low, strict=True)
        ]
        high = [
            np.inf if name == f"{one} ≤" else bound
            for one, bound in zip(structure.names, structure.high, strict=True)
        ]
        left = tuple(one for one in self.requirements if one.name != name)
        free = replace(structure, low=tuple(low), high=tuple(high))
        return replace(self, structure=free, requirements=left)

    @property
    def peaks(self) -> tuple[Peak, ...]:
        """The bounds on closed-loop functions."""
        return tuple(one for one in self.requirements if isinstance(one, Peak))

    @property
    def norms(self) -> tuple[Norm, ...]:
        """The bounds on norms."""
        return tuple(one for one in self.requirements if isinstance(one, Norm))

    @property
    def cones(self) -> tuple[Cone, ...]:
        """The cones in the space of the parameters."""
        return tuple(one for one in self.requirements if isinstance(one, Cone))

    @property
    def concave(self) -> tuple[Concave, ...]:
        """The concave functions."""
        return tuple(one for one in self.requirements if isinstance(one, Concave))

    @property
    def linear(self) -> tuple[Linear, ...]:
        """The linear requirements, the structure's bounds included."""
        own = tuple(one for one in self.requirements if isinstance(one, Linear))
        return own + self.bounds

    @property
    def bounds(self) -> tuple[Linear, ...]:
        """The structure's bounds as requirements, ``"k_p ≥"`` and ``"k_p ≤"``."""
        structure, found = self.structure, []
        for k, unit in enumerate(np.eye(len(structure.names))):
            if np.isfinite(structure.high[k]):
                found.append(Linear(f"{structure.names[k]} ≤", unit, structure.high[k]))
            if np.isfinite(structure.low[k]):
                found.append(Linear(f"{structure.names[k]} ≥", -unit, -structure.low[k]))
        return tuple(found)


def sampled_curve(omega: FloatArray, values: FloatArray) -> Curve:
    """Return a bound given at some frequencies ``(F,)``, all above 0, as a curve.

    Logarithms are interpolated, which is optimistic for a bound that dips between its points.
    """
    grid, logarithms = np.log(omega), np.log(values)
    return lambda wanted: np.exp(np.interp(np.log(wanted), grid, logarithms))


def curve_at(curve: Curve, omega: FloatArray) -> FloatArray:
    """Return a bound's values, ``(F,)``."""
    if callable(curve):
        return np.asarray(curve(omega), np.float64)
    return np.full(len(omega), float(curve))
