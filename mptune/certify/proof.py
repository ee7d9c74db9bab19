"""A search, from a box in coordinates to a verdict: what stands between Python and the kernel."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mptune.certify.enclosure import GAIN, OMEGA, RATIO, SIDES
from mptune.certify.folded import NOTHING, LeftOut
from mptune.certify.form import COMPLIANCE
from mptune.certify.sampled import left_out, offset_of, remainder, shifts_of, truncated_bound
from mptune.certify.search import OPEN, PROVED, Rest, search
from mptune.loops.broken import SAMPLED

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.certify.form import Form

_ROOM = 512  # boxes that a depth-first search may add to its list
_OCTAVES = 12  # of frequency, into which the box is cut to begin with
_FOLDED_CUTS = 6  # of an octave, where what is left out rises with the frequency


def cover(edges: FloatArray, curve: FloatArray, per_octave: int = 1) -> FloatArray:
    """Return a box cut along the frequency axis, ``(N, 2, SIDES)``.

    It is cut by octaves, since figures change with ln ω, or into more parts than one of each, and
    at the corners of a curve.
    """
    low, high = float(edges[0, OMEGA]), float(edges[1, OMEGA])
    cuts = high * 2.0 ** (-np.arange(_OCTAVES * per_octave + 1.0) / per_octave)
    cuts = np.unique(np.concatenate([cuts, curve[:, 0], [low, high]]))
    cuts = cuts[(cuts >= low) & (cuts <= high)]
    parts = np.repeat(edges[None], max(len(cuts) - 1, 1), axis=0)
    if len(cuts) > 1:
        parts[:, 0, OMEGA], parts[:, 1, OMEGA] = cuts[:-1], cuts[1:]
    return parts


def _left_out(
    form: Form, ratio: float, terms: int, end: float, louder: float
) -> tuple[float, LeftOut]:
    """Return what is left out up to a frequency, as a number or by the plants' lags."""
    if form.path.estimator_mass > 0:
        return 0.0, left_out(form, ratio, terms, end)
    return louder * remainder(form, ratio, terms, end), NOTHING


class _Part:
    """A list of boxes that ends at one frequency, and what a truncated loop leaves out up to it."""

    def __init__(
        self,
        boxes: FloatArray,
        left_out: float,
        by_lags: LeftOut = NOTHING,
        weight: float = 1.0,
    ) -> None:
        self.left, self.left_out, self.by_lags = len(boxes), left_out, by_lags
        self.weight = weight
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
        folded = form.loop == SAMPLED and form.path.estimator_mass > 0
        boxes = cover(edges, curve, _FOLDED_CUTS if folded else 1)
        self._shifts = np.zeros(1)
        self._parts = [_Part(boxes, 0.0)]
        if form.loop == SAMPLED:
            self._shifts = shifts_of(form, terms)
            ratio = float(edges[1, RATIO])
            ends = [float(box[1, OMEGA]) for box in boxes]
            louder = math.exp(float(edges[1, GAIN]))  # of what is left out as a number
            time = form.nominal.mass / form.gains.k_p_vel
            self._parts = [
                _Part(
                    boxes[i : i + 1],
                    *_left_out(form, ratio, terms, ends[i], louder),
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
            status = self._search(part, sought, budget)
            if status != PROVED:
                break
        return status

    def run_nonzero(self, budget: int) -> int:
        """Prove that 1 + L has no zero; the figure is an S of the velocity loop or at F_ref."""
        status = PROVED
        for part in self._parts:
            status = self._search(part, 0.0, budget)
            if status != PROVED:
                break
        return status

    def _search(self, part: _Part, sought: float, budget: int) -> int:
        """Search one part for the figure above ``sought``; for zeros of 1 + L where that is 0."""
        num, den = (1.0, sought * sought) if sought > 0 else (part.left_out**2, 1.0)
        form = self.form
        time = form.nominal.mass / form.gains.k_p_vel if form.figure == COMPLIANCE else 0.0
        rest = Rest(*part.by_lags, offset_of(form), float(sought), time)
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
            rest,
        )
        self.boxes += found.boxes
        part.left = found.left
        return int(found.status)
