"""A search, from a box in coordinates to a verdict: what stands between Python and the kernel."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from mptune.certify.enclosure import OMEGA, SIDES
from mptune.certify.search import search

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.certify.form import Form

_ROOM = 1024  # boxes that a depth-first search may add to its list
_OCTAVES = 12  # of frequency, into which the box is cut to begin with


def cover(edges: FloatArray, curve: FloatArray) -> FloatArray:
    """Return a box cut along the frequency axis, ``(N, 2, SIDES)``.

    It is cut by octaves, since figures change with ln ω, and at the corners of a curve.
    """
    low, high = float(edges[0, OMEGA]), float(edges[1, OMEGA])
    cuts = high * 2.0 ** -np.arange(_OCTAVES + 1.0)
    cuts = np.unique(np.concatenate([cuts, curve[:, 0], [low, high]]))
    cuts = cuts[(cuts >= low) & (cuts <= high)]
    parts = np.repeat(edges[None], max(len(cuts) - 1, 1), axis=0)
    if len(cuts) > 1:
        parts[:, 0, OMEGA], parts[:, 1, OMEGA] = cuts[:-1], cuts[1:]
    return parts


@dataclass
class Proof:
    """A list of boxes on which a figure is being proved to be below a bound.

    What has been proved for a bound stays proved for a higher one, so that only ``left`` boxes are
    asked when the bound rises.
    """

    form: Form
    shifts: FloatArray
    curve: FloatArray
    edges: FloatArray
    boxes: int = 0
    left: int = field(init=False)
    point: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        """Put the whole box on the list."""
        parts = cover(self.edges, self.curve)
        self.left = len(parts)
        self._lows = np.empty((self.left + _ROOM, SIDES))
        self._highs = np.empty((self.left + _ROOM, SIDES))
        self._lows[: self.left], self._highs[: self.left] = parts[:, 0], parts[:, 1]
        self.point = np.empty(SIDES)

    def run(self, bound: float, budget: int) -> int:
        """Prove the figure below a bound; return how the search ended, its place in ``point``."""
        return self._run(1.0, bound * bound, budget)

    def run_nonzero(self, least: float, budget: int) -> int:
        """Prove |d| > least·|n|; the figure is an S of the velocity loop or of that at F_ref."""
        return self._run(least * least, 1.0, budget)

    def _run(self, num: float, den: float, budget: int) -> int:
        found = search(
            self.form,
            self.shifts,
            self.curve,
            float(num),
            float(den),
            self._lows,
            self._highs,
            self.left,
            budget,
            self.point,
        )
        self.boxes += found.boxes
        self.left = found.left
        return int(found.status)
