"""From a first attained value to a proved bound: find high places, prove, climb, prove again."""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from mptune.certify.climb import SINGULAR, explore
from mptune.certify.enclosure import OMEGA, RATIO, SIDES
from mptune.certify.form import COMPLIANCE, EQUATION_17, EQUATION_21, MIXTURE
from mptune.certify.problem import edges_of
from mptune.certify.sampled import terms_for
from mptune.certify.search import ABOVE, PROVED
from mptune.certify.tails import tail_start
from mptune.loops.broken import SAMPLED

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.certify.form import Form
    from mptune.certify.problem import BoxedLoop
    from mptune.certify.proof import Proof

SMALLEST = 1e-3  # a figure below it is not told apart from it
_FREQUENCIES = 160
_DECADES = 4
_CLIMBS = 4
_FIRST_LEVELS = {EQUATION_17: 0.3, EQUATION_21: 0.2, MIXTURE: 1.3, COMPLIANCE: 1.0}
_RAISES = 12  # bounds that are tried before a figure is said to have none
_ABOVE = 1.5  # times the peak's frequency: up to there a remainder has to be small
_NOWHERE = np.empty(0)


def attain(
    problem: BoxedLoop, form: Form, curve: FloatArray, tolerance: float
) -> tuple[float, FloatArray, FloatArray]:
    """Return a high value of a figure, its place, and the box of coordinates to be proved.

    The box ends at the frequency beyond which the figure is certainly below the bound to be.
    """
    edges = edges_of(problem, (0.0, 0.0))
    least = float(curve[:, 1].min()) if len(curve) else 1.0
    limit = abs(form.share_s) if form.loop != SAMPLED else 0.0  # at the highest frequencies
    level = max(_FIRST_LEVELS[form.figure] * least, 1.3 * limit)
    attained, point = -1.0, np.empty(SIDES)
    while True:
        end = np.pi / form.period
        if form.loop != SAMPLED:
            end = tail_start(form, edges[1, RATIO], level)
        if end > edges[1, OMEGA]:
            edges[1, OMEGA] = end
            value, place = explored(form, curve, edges)
            if value > attained:
                attained, point = value, place
        if attained < limit:
            attained = limit
            point[OMEGA] = math.inf
        wanted = (1 + tolerance / 2) * max(attained, SMALLEST) * least
        if form.loop == SAMPLED or wanted >= level:
            break
        level = wanted
    if form.loop != SAMPLED:
        edges[1, OMEGA] = tail_start(form, edges[1, RATIO], wanted)
    return attained, point, edges


def explored(
    form: Form, curve: FloatArray, edges: FloatArray, frequencies: int = _FREQUENCIES
) -> tuple[float, FloatArray]:
    """Return a high value of a figure within a box of coordinates, and its place.

    Corners and centre are tried at so many frequencies, and followed uphill from the best.
    """
    low, high = float(edges[0, OMEGA]), float(edges[1, OMEGA])
    omega = np.geomspace(max(low, high * 10.0**-_DECADES), high, frequencies)
    omega[0] = low
    middle = 0.5 * (edges[0] + edges[1])
    sides = [sorted({float(low), float(high)}) for low, high in edges[:, 1:].T]
    plants = np.array([middle, *((0.0, *corner) for corner in product(*sides))])
    place = np.empty(SIDES)
    value = explore(form, curve, edges, omega, plants, _CLIMBS, 0.25, place)
    return float(value), place


def close(
    proof: Proof, attained: float, point: FloatArray, step: float, budget: int
) -> tuple[float, float]:
    """Return the attained value and a proved bound, at best (1 + step) times as high.

    ``point`` is moved along with the attained value. Where the search comes to no end the bound is
    raised, by more every time, and in the end given up.
    """
    sought = (1 + step) * max(attained, SMALLEST)
    left = budget
    for raised in range(1, _RAISES):
        status = ABOVE
        while status == ABOVE and attained < SINGULAR:
            boxes = proof.boxes
            status = proof.run(sought, left)
            left -= proof.boxes - boxes
            if status == ABOVE:
                place, start = np.empty(SIDES), proof.point[None].copy()
                value = float(
                    explore(proof.form, proof.curve, proof.edges, _NOWHERE, start, 1, 0.01, place)
                )
                if (1 + step) * value <= sought:
                    break
                attained, sought = value, (1 + step) * value
                point[:] = place
        if status == PROVED:
            return attained, sought * (1 + 1e-15)
        if attained >= SINGULAR:
            return attained, math.inf
        sought *= 1 + step * 4.0**raised
        left = max(left, budget // 4)
    return attained, math.inf


def terms_of(
    form: Form, edges: FloatArray, attained: float, point: FloatArray, tolerance: float
) -> int:
    """Return the K of the loop as it runs whose remainder hardly widens the gap; 0 of others."""
    if form.loop != SAMPLED:
        return 0
    omega = _ABOVE * float(min(point[OMEGA], edges[1, OMEGA]))
    return terms_for(form, float(edges[1, RATIO]), omega, tolerance / (4 * (1 + attained)))
