"""The loops at work: quotients of found and allowed, their peaks, and linearised rows."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.shape.problem import Function, WeightedSensitivity, curve_at
from mptune.shape.step import ConeRows

if TYPE_CHECKING:
    from mptune.arrays import ComplexArray, FloatArray, IntArray
    from mptune.shape.problem import Loops, Peak, Problem
    from mptune.shape.structure import Structure

GUARD = 0.02  # of its distance from −1 that no loop may lose in a step, seen from where it was
IN_HAND = 1e-5  # of every bound, for the solver's tolerance and what refinement leaves open
_NEARLY = 0.9  # of the bound: peaks below are not refined
_CLOSE = 1e-4  # relative distance of frequencies below which refinement ends…
_RISE = 1e-6  # …unless a peak is so sharp that its parabola rises by more than this share
_CLOSEST = 1e-9  # relative distance at which it ends even so
_ROUNDS = 8


class Key(NamedTuple):
    """One row of a step: which kind, which loop, which plant, which frequency."""

    kind: str  # a peak's name, "guard" or "objective"
    loops: str
    plant: int
    omega: float


@dataclass(frozen=True)
class _Sampled:
    """One set of loops with the basis at its frequencies and, by kind, the inverse bounds."""

    loops: Loops
    basis: ComplexArray  # (K, F)
    inverse: dict[str, FloatArray]  # (F,)


class Curves:
    """All loops at work, on grids that grow where peaks want to be seen."""

    def __init__(
        self,
        structure: Structure,
        peaks: dict[str, Peak],
        weighted: WeightedSensitivity | None,
        sampled: dict[str, _Sampled],
    ) -> None:
        self._structure, self.peaks, self._weighted = structure, peaks, weighted
        self._sampled = sampled

    @classmethod
    def of(cls, problem: Problem) -> Curves:
        """Return the curves of all loops of a problem."""
        objective = problem.objective
        weighted = objective if isinstance(objective, WeightedSensitivity) else None
        curves = cls(problem.structure, {peak.name: peak for peak in problem.peaks}, weighted, {})
        for name, one in problem.loops.items():
            basis = problem.structure.response(one.omega)
            curves._sampled[name] = _Sampled(one, basis, curves._bounds(name, one.omega))
        return curves

    def picked(self, rows: dict[str, IntArray]) -> Curves:
        """Return the curves of some plants of each set of loops."""
        sampled = {
            name: replace(one, loops=one.loops.picked(rows[name]))
            for name, one in self._sampled.items()
        }
        return Curves(self._structure, self.peaks, self._weighted, sampled)

    def without(self, name: str) -> Curves:
        """Return the curves without one requirement."""
        peaks = {key: peak for key, peak in self.peaks.items() if key != name}
        sampled = {
            loops: replace(
                one, inverse={key: curve for key, curve in one.inverse.items() if key != name}
            )
            for loops, one in self._sampled.items()
        }
        return Curves(self._structure, peaks, self._weighted, sampled)

    def _bounds(self, name: str, omega: FloatArray) -> dict[str, FloatArray]:
        """Return the inverse of every bound on some loops, and the objective's weight."""
        inverse = {
            peak.name: 1 / curve_at(peak.largest, omega)
            for peak in self.peaks.values()
            if peak.loops == name
        }
        if self._weighted is not None and self._weighted.loops == name:
            inverse["objective"] = curve_at(self._weighted.weight, omega)
        return inverse

    def _refined(self, name: str, added: FloatArray) -> _Sampled:
        """Return one set of loops with frequencies added."""
        one = self._sampled[name]
        place = np.searchsorted(one.loops.omega, added)
        bounds = self._bounds(name, added)
        return _Sampled(
            one.loops.refined(added),
            np.insert(one.basis, place, self._structure.response(added), axis=1),
            {kind: np.insert(one.inverse[kind], place, bounds[kind]) for kind in bounds},
        )

    def _difference(self, one: _Sampled, x: FloatArray) -> ComplexArray:
        return 1 + one.loops.gain(x @ one.basis)  # (N, F)

    def _quotient(self, one: _Sampled, kind: str, x: FloatArray) -> FloatArray:
        """Return found over allowed ``(N, F)``; w|S| for the objective."""
        distance = self._difference(one, x)
        numerator = self._numerator(one, kind, x, distance)
        return np.asarray(numerator * one.inverse[kind] / np.abs(distance))

    def _numerator(
        self, one: _Sampled, kind: str, x: FloatArray, distance: ComplexArray
    ) -> FloatArray | float:
        peak = self.peaks.get(kind)
        if peak is None or peak.function is Function.SENSITIVITY:
            return 1.0
        if peak.function is Function.COMPLEMENTARY:
            return np.abs(distance - 1)
        return np.abs(x @ one.basis)

    def refine(self, x: FloatArray) -> None:
        """Add the frequencies of the peaks of every curve that nearly meets its bound."""
        for name, one in self._sampled.items():
            if one.loops.between is None:
                continue
            for _ in range(_ROUNDS):
                current = self._sampled[name]
                added = [self._vertices(current, kind, x) for kind in current.inverse]
                new = np.unique(np.concatenate(added)) if added else np.zeros(0)
                if not len(new):
                    break
                self._sampled[name] = self._refined(name, new)

    def _vertices(self, one: _Sampled, kind: str, x: FloatArray) -> FloatArray:
        """Return frequencies to add; the kinks of a bound that is a curve are no sharp peaks."""
        smooth = kind in self.peaks and not callable(self.peaks[kind].largest)
        rise = _RISE if smooth else np.inf
        return _vertices(one.loops.omega, self._quotient(one, kind, x), kind, rise)

    def worst(self, x: FloatArray) -> dict[str, tuple[float, float, int]]:
        """Return by kind the largest quotient, its frequency and its plant."""
        found = {}
        for one in self._sampled.values():
            for kind in one.inverse:
                quotient = self._quotient(one, kind, x)
                plant, place = np.unravel_index(np.argmax(quotient), quotient.shape)
                at = float(one.loops.omega[place])
                found[kind] = (float(quotient[plant, place]), at, int(plant))
        return found

    def loops_of(self, kind: str) -> str:
        """Return the name of the loops that a curve belongs to."""
        return next(name for name, one in self._sampled.items() if kind in one.inverse)

    def largest_plants(self, x: FloatArray, name: str, most: int) -> IntArray:
        """Return the plants of some loops with the largest quotients, ``most`` for each curve."""
        one = self._sampled[name]
        highest = [self._quotient(one, kind, x).max(axis=1) for kind in one.inverse]
        chosen = [np.argsort(-values)[:most] for values in highest]
        return np.unique(np.concatenate([np.zeros(0, np.int64), *chosen]))

    def highest(self, x: FloatArray, floor: float) -> set[Key]:
        """Return the peaks of every curve above a share of its maximum, and a few guards."""
        keys = set()
        for name, one in self._sampled.items():
            nearest = np.argmin(np.abs(self._difference(one, x)), axis=1)
            for plant, place in enumerate(nearest):
                keys.add(Key("guard", name, plant, float(one.loops.omega[place])))
            for kind in one.inverse:
                quotient = self._quotient(one, kind, x)
                keys |= _keys(kind, name, one.loops.omega, quotient, floor * quotient.max())
        return keys

    def violated(
        self,
        x: FloatArray,
        y: FloatArray,
        gamma: float,
        slack: float,
        relief: dict[str, float],
        tolerance: float,
    ) -> set[Key]:
        """Return the worst rows, linearised at x, that y does not keep."""
        keys = set()
        for name, one in self._sampled.items():
            before, after = self._difference(one, x), self._difference(one, y)
            size = np.abs(before)
            right = np.real(np.conj(before) * after) / size**2
            keys |= _keys("guard", name, one.loops.omega, GUARD - right, tolerance)
            for kind, inverse in one.inverse.items():
                asked = gamma if kind == "objective" else 1 + IN_HAND
                left = self._numerator(one, kind, y, after) * inverse * asked / size
                excess = left - right - slack * relief.get(kind, 0.0)
                keys |= _keys(kind, name, one.loops.omega, excess, tolerance)
        return keys

    def keeps_turning(self, x: FloatArray, y: FloatArray) -> bool:
        """Return whether no loop can have met −1 on the straight way from x to y."""
        for one in self._sampled.values():
            before, after = self._difference(one, x), self._difference(one, y)
            if np.any(np.real(np.conj(before) * after) <= 0):
                return False
        return True

    def rows(
        self, x: FloatArray, scale: FloatArray, keys: set[Key], relief: dict[str, float]
    ) -> ConeRows:
        """Return the rows of a step from x, linearised at x, normalised by |1 + L(x)|."""
        groups: dict[tuple[str, str], list[Key]] = {}
        for key in sorted(keys):
            groups.setdefault((key.kind, key.loops), []).append(key)
        return ConeRows.joined(
            [
                self._group(x, scale, kind, self._sampled[name], members, relief.get(kind, 0.0))
                for (kind, name), members in groups.items()
            ]
        )

    def _group(
        self,
        x: FloatArray,
        scale: FloatArray,
        kind: str,
        one: _Sampled,
        keys: list[Key],
        relief: float,
    ) -> ConeRows:
        plant = np.array([key.plant for key in keys])
        place = np.searchsorted(one.loops.omega, [key.omega for key in keys])
        basis = one.basis[:, place].T * scale  # (R, K)
        slope: ComplexArray = one.loops.plant[plant, place][:, None] * basis
        distance = (
            1
            + one.loops.fixed[plant, place]
            + one.loops.plant[plant, place] * (x @ one.basis[:, place])
        )
        size = np.abs(distance)
        right = np.real(np.conj(distance)[:, None] * slope) / size[:, None] ** 2
        zero, ones = np.zeros(len(keys)), np.ones(len(keys))
        empty = np.zeros(slope.shape, np.complex128)
        if kind == "guard":
            return ConeRows(
                right, ones, empty, np.full(len(keys), GUARD, np.complex128), zero, zero
            )
        factor = one.inverse[kind][place] / size
        if kind == "objective":
            return ConeRows(right, ones, empty, empty[:, 0], factor, zero)
        factor = factor * (1 + IN_HAND)
        function = self.peaks[kind].function
        if function is Function.SENSITIVITY:
            return ConeRows(right, ones, empty, factor.astype(np.complex128), zero, relief * ones)
        if function is Function.COMPLEMENTARY:
            left, left_0 = slope * factor[:, None], (distance - 1) * factor
        else:
            left, left_0 = basis * factor[:, None], (x @ one.basis[:, place]) * factor
        return ConeRows(right, ones, left, left_0, zero, relief * ones)


def _keys(kind: str, name: str, omega: FloatArray, values: FloatArray, floor: float) -> set[Key]:
    """Return the local maxima above a floor, of each plant."""
    plant, place = _maxima(values, floor)
    return {Key(kind, name, int(n), float(omega[f])) for n, f in zip(plant, place, strict=True)}


def _maxima(values: FloatArray, floor: float) -> tuple[IntArray, IntArray]:
    edge = np.full((len(values), 1), -np.inf)
    padded = np.concatenate([edge, values, edge], axis=1)
    top = (values > floor) & (values >= padded[:, :-2]) & (values > padded[:, 2:])
    plant, place = np.nonzero(top)
    return plant.astype(np.int64), place.astype(np.int64)


def _vertices(omega: FloatArray, quotient: FloatArray, kind: str, rise: float) -> FloatArray:
    """Return the vertices of the parabolas through the peaks that matter, where not on the grid."""
    floor = _NEARLY * (quotient.max() if kind == "objective" else max(1.0, quotient.max()))
    plant, place = _maxima(quotient, floor)
    inner = (place > 0) & (place < len(omega) - 1)
    plant, place = plant[inner], place[inner]
    x = np.log(omega)
    left, right = x[place - 1] - x[place], x[place + 1] - x[place]
    down = quotient[plant, place - 1] - quotient[plant, place]
    up = quotient[plant, place + 1] - quotient[plant, place]
    bend = up * left - down * right
    usable = bend != 0
    vertex = np.zeros(len(place))
    np.divide(0.5 * (up * left**2 - down * right**2), bend, out=vertex, where=usable)
    vertex = np.clip(vertex, 0.9 * left, 0.9 * right)
    away = np.minimum(np.abs(vertex), np.minimum(vertex - left, right - vertex))
    slope = (down * right**2 - up * left**2) / (left * right * (right - left))
    sharp = 0.5 * slope * vertex > rise * quotient[plant, place]
    new = usable & ((away > _CLOSE) | (sharp & (away > _CLOSEST)))
    return np.unique(np.exp(x[place] + vertex)[new])
