"""A search, from a box in coordinates to a verdict: what stands between Python and the kernel."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.certify.enclosure import OMEGA, RATIO, SIDES
from mptune.certify.sampled import remainder, shifts_up_to, truncated_bound
from mptune.certify.search import OPEN, PROVED, search
from mptune.loops.broken import SAMPLED

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.certify.form import Form

_ROOM = 512  # boxes that a depth-first search may add to its list
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


class _Part:
    """A list of boxes that ends at one frequency, and what a truncated loop leaves out up to it."""

    def __init__(self, boxes: FloatArray, left_out: float, weight: float = 1.0) -> None:
        self.left, self.left_out, self.weight = len(boxes), left_out, weight
        self.lows, self.highs = np.empty((2, self.left + _ROOM, SIDES))
        self.lows[: self.left], self.highs[: self.left] = boxes[:, 0], boxes[:, 1]


class Proof:
    """A box over which a figure is being proved to be below a bound.

    What has been proved for a bound stays proved for a higher one, so that only boxes that are left
    are asked when the bound rises.

    Parameters
    ----------
    form, curve
        The figure, and what it is divided by.
    edges
        ``(2, SIDES)``: the box.
    terms
        K, of the loop as it runs: its aliases up to ±K stand in the sum.

    Attributes
    ----------
    boxes
        Boxes tried so far.
    point
        ``(SIDES,)``: where the last search ended.
    """

    def __init__(self, form: Form, curve: FloatArray, edges: FloatArray, terms: int = 0) -> None:
        self.form, self.curve, self.edges = form, curve, edges
        self.boxes, self.point = 0, np.empty(SIDES)
        boxes = cover(edges, curve)
        self._shifts = np.zeros(1)
        self._parts = [_Part(boxes, 0.0)]
        if form.loop == SAMPLED:
            self._shifts = shifts_up_to(terms, form.period)
            ratio = float(edges[1, RATIO])
            ends = [float(box[1, OMEGA]) for box in boxes]
            time = form.nominal.mass / form.gains.k_p_vel
            self._parts = [
                _Part(
                    boxes[i : i + 1],
                    remainder(form, ratio, terms, ends[i]),
                    float(edges[0, RATIO]) / (ends[i] * time) ** 2,  # the least μ/|P|²
                )
                for i in range(len(ends))
            ]

    def run(self, bound: float, budget: int) -> int:
        """Prove the figure below a bound; return how the search ended, its place in ``point``."""
        status = PROVED
        for part in self._parts:
            sought = bound
            if part.left_out > 0:
                sought = truncated_bound(self.form, bound, part.left_out, part.weight)
                if sought <= 0:
                    return OPEN
            status = self._search(part, 1.0, sought * sought, budget)
            if status != PROVED:
                break
        return status

    def run_nonzero(self, budget: int) -> int:
        """Prove that 1 + L has no zero; the figure is an S of the velocity loop or at F_ref."""
        status = PROVED
        for part in self._parts:
            status = self._search(part, part.left_out**2, 1.0, budget)
            if status != PROVED:
                break
        return status

    def _search(self, part: _Part, num: float, den: float, budget: int) -> int:
        if part.left == 0:
            return PROVED
        found = search(
            self.form,
            self._shifts,
            self.curve,
            float(num),
            float(den),
            part.lows,
            part.highs,
            part.left,
            budget,
            self.point,
        )
        self.boxes += found.boxes
        part.left = found.left
        return int(found.status)
