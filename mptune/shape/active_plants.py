"""The few plants of a family that bind: tuned on, while the whole family gives the verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.shape.curves import Curves
from mptune.shape.procedure import Use

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.shape.problem import Problem

_FEW = 3  # loops that need no picking
_LOOKED_AT = 10  # plants per curve whose peaks are refined for a verdict


class ActivePlants:
    """A growing set of plants of one problem, by the name of their loops."""

    def __init__(self, problem: Problem, start: FloatArray) -> None:
        self._whole = Curves.of(problem)
        self._rows = {
            name: np.arange(len(loops) if len(loops) <= _FEW else 1)
            for name, loops in problem.loops.items()
        }
        self.add(start, -np.inf)

    def curves(self) -> Curves:
        """Return a curves of the plants picked."""
        return self._whole.picked(self._rows)

    def worst(self, x: FloatArray) -> dict[str, Use]:
        """Return each curve's largest quotient over all plants, the highest peaks refined."""
        rows = {
            name: np.union1d(which, self._whole.largest_plants(x, name, _LOOKED_AT))
            for name, which in self._rows.items()
        }
        curves = self._whole.picked(rows)
        curves.refine(x)
        found = {}
        for kind, (quotient, frequency, plant) in curves.worst(x).items():
            place = int(rows[curves.loops_of(kind)][plant])
            found[kind] = Use(kind, quotient, frequency, place)
        return found

    def add(self, x: FloatArray, floor: float, objective_floor: float = np.inf) -> bool:
        """Pick each curve's worst plant where above a floor; return whether any is new."""
        new = False
        for kind, use in self.worst(x).items():
            name = self._whole.loops_of(kind)
            above = use.quotient > (objective_floor if kind == "objective" else floor)
            if above and use.plant not in self._rows[name]:
                self._rows[name] = np.union1d(self._rows[name], [use.plant])
                new = True
        return new
