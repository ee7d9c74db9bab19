"""The few plants of a family that bind: tuned on, while the whole family gives the verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.tune.board import Board
from mptune.tune.convex import Use

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.tune.problem import Problem

_FEW = 3  # loops that need no picking
_LOOKED_AT = 10  # plants per curve whose peaks are refined for a verdict


class Picks:
    """A growing set of plants of one problem, by the name of their loops."""

    def __init__(self, problem: Problem, start: FloatArray) -> None:
        self._whole = Board.of(problem)
        self._rows = {
            name: np.arange(len(loops) if len(loops) <= _FEW else 1)
            for name, loops in problem.loops.items()
        }
        self.add(start, -np.inf)

    def board(self) -> Board:
        """Return a board of the plants picked."""
        return self._whole.picked(self._rows)

    def worst(self, x: FloatArray) -> dict[str, Use]:
        """Return each curve's largest quotient over all plants, the highest peaks refined."""
        rows = {
            name: np.union1d(which, self._whole.largest_plants(x, name, _LOOKED_AT))
            for name, which in self._rows.items()
        }
        board = self._whole.picked(rows)
        board.refine(x)
        found = {}
        for kind, (quotient, frequency, plant) in board.worst(x).items():
            place = int(rows[board.loops_of(kind)][plant])
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
