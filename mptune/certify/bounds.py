"""Attained and guaranteed worst cases of one figure over a box."""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from mptune.certify.climb import SINGULAR, explore
from mptune.certify.enclosure import OMEGA, RATIO, SIDES
from mptune.certify.form import EQUATION_17, EQUATION_21, MIXTURE, Curve, curve_of, form_of
from mptune.certify.problem import Point, edges_of
from mptune.certify.proof import Proof
from mptune.certify.result import Bound
from mptune.certify.sampled import terms_for
from mptune.certify.search import ABOVE, PROVED
from mptune.certify.stability import corner_verdict, point_of, witness_near
from mptune.certify.tails import tail_start
from mptune.loops.broken import POSITION, SAMPLED

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.certify.form import Form
    from mptune.certify.problem import Problem

TOLERANCE = 1e-3  # ε
BUDGET = 1_000_000  # boxes, at most, before a bound is given up for a higher one
_FREQUENCIES = 160
_DECADES = 4
_CLIMBS = 4
_SMALLEST = 1e-3  # a ratio of Eq. 17 or Eq. 21 below it is not told apart from it
_FIRST_LEVELS = {EQUATION_17: 0.3, EQUATION_21: 0.2, MIXTURE: 1.3}
_RAISES = 12  # bounds that are tried before a figure is said to have none
_ABOVE = 1.5  # times the peak's frequency: up to there a remainder has to be small
_NOWHERE = np.empty(0)


def bound(
    problem: Problem,
    loop: str,
    path: str,
    figure: str,
    *,
    tolerance: float = TOLERANCE,
    allowed: float | Curve = 1.0,
    budget: int = BUDGET,
) -> Bound:
    """Return the attained and the guaranteed worst value of one figure over the whole box.

    Parameters
    ----------
    problem
        The box and the loop.
    loop
        ``"velocity"`` (Eq. 17), ``"position"`` (Eq. 21) or ``"force_reference"``.
    path
        ``"none"``, ``"filters"``, or ``"sampled"`` for the loop at F_ref as it runs.
    figure
        ``"equation_17"``, ``"equation_21"``, ``"sensitivity_peak"``, ``"complementary_peak"`` or
        ``"disk_margin"``.
    tolerance
        How far apart both may be, relative to the attained value.
    allowed
        The largest allowed ratio of an equation, a number or a curve over frequency: the figure is
        then what a plant uses of it.
    budget
        Boxes to try at most.

    Returns
    -------
    Bound
        Both values; infinite where the box holds a plant whose loop is unstable.

    Raises
    ------
    ValueError
        If there is no such figure of that loop with that path.
    """
    form = form_of(problem, loop, path, figure)
    name = loop, path, figure
    witness = _corner_witness(problem, form, loop, path)
    if witness is not None:
        return _result(name, math.inf, witness, math.inf, tolerance, 0)
    if _no_loop(form):
        value = 2.0 if figure == "disk_margin" else form.share_s
        return Bound(loop, path, figure, value, None, value, closed=True, boxes=0)
    curve = curve_of(allowed)
    attained, point, edges = attain(problem, form, curve, tolerance)
    terms = 0
    if form.loop == SAMPLED:
        heard = _ABOVE * float(min(point[OMEGA], edges[1, OMEGA]))
        terms = terms_for(form, edges[1, RATIO], heard, tolerance / (4 * (1 + attained)))
    proof = Proof(form, curve, edges, terms)
    attained, proved = _close(proof, attained, point, tolerance, budget)
    at = point_of(problem, point)
    if attained >= SINGULAR or not math.isfinite(proved):
        witness = _witness_near(problem, form, point, loop, path)
        if witness is not None:
            return _result(name, math.inf, witness, math.inf, tolerance, proof.boxes)
    return _result(name, attained, at, proved, tolerance, proof.boxes)


def _no_loop(form: Form) -> bool:
    """Return whether there is no position loop: then S = 1, T = 0 and Eq. 21's ratio is 0."""
    gains = form.gains
    position = form.figure == EQUATION_21 or (form.figure == MIXTURE and form.loop == POSITION)
    return position and gains.k_p_pos == 0 and gains.k_i_pos == 0


def _corner_witness(problem: Problem, form: Form, loop: str, path: str) -> Point | None:
    """Return a plant on whose account the figure is infinite, among the box's corners.

    An S, a T or a margin of an unstable loop is none. Eq. 21 is infinite where the velocity loop
    of a plant has a pole on the imaginary axis: between a stable corner and an unstable one.
    """
    if form.figure == EQUATION_17:
        return None
    witness, some_stable = corner_verdict(problem, path, _asked(form, loop))
    return witness if some_stable or form.figure == MIXTURE else None


def _witness_near(
    problem: Problem, form: Form, place: FloatArray, loop: str, path: str
) -> Point | None:
    """Return the same, looked for beside a place where the figure is very high."""
    if form.figure == EQUATION_17:
        return None
    asked = _asked(form, loop)
    if form.figure == EQUATION_21 and not corner_verdict(problem, path, asked)[1]:
        return None
    return witness_near(problem, place, path, asked)


def _asked(form: Form, loop: str) -> str:
    """Return the loop whose stability the figure asks for."""
    velocity = loop == "velocity" or form.figure == EQUATION_21
    return "velocity" if velocity else "force_reference"


def attain(
    problem: Problem, form: Form, curve: FloatArray, tolerance: float, phase: float = 0.0
) -> tuple[float, FloatArray, FloatArray]:
    """Return a high value of a figure, its place, and the box of coordinates to be proved.

    The box ends at the frequency beyond which the figure is certainly below the bound to be.
    """
    edges = edges_of(problem, (0.0, 0.0), phase)
    least = float(curve[:, 1].min()) if len(curve) else 1.0
    limit = abs(form.share_s)  # of vanishing loop gain, at the highest frequencies
    level = max(_FIRST_LEVELS[form.figure] * least, 1.3 * limit)
    attained, point = -1.0, np.empty(SIDES)
    while True:
        end = np.pi / form.period
        if form.loop != SAMPLED:
            end = tail_start(form, edges[1, RATIO], level)
        if end > edges[1, OMEGA]:
            edges[1, OMEGA] = end
            value, place = _explored(form, curve, edges)
            if value > attained:
                attained, point = value, place
        if attained < limit:
            attained = limit
            point[OMEGA] = math.inf
        wanted = (1 + tolerance / 2) * max(attained, _SMALLEST) * least
        if form.loop == SAMPLED or wanted >= level:
            break
        level = wanted
    if form.loop != SAMPLED:
        edges[1, OMEGA] = tail_start(form, edges[1, RATIO], wanted)
    return attained, point, edges


def _explored(form: Form, curve: FloatArray, edges: FloatArray) -> tuple[float, FloatArray]:
    end = edges[1, OMEGA]
    omega = np.append(end * np.geomspace(10.0**-_DECADES, 1.0, _FREQUENCIES), edges[0, OMEGA])
    middle = 0.5 * (edges[0] + edges[1])
    sides = [sorted({float(low), float(high)}) for low, high in edges[:, 1:].T]
    plants = np.array([middle, *((0.0, *corner) for corner in product(*sides))])
    place = np.empty(SIDES)
    value = explore(form, curve, edges, omega, plants, _CLIMBS, 0.25, place)
    return float(value), place


def _close(
    proof: Proof, attained: float, point: FloatArray, step: float, budget: int
) -> tuple[float, float]:
    """Return the attained value and a proved bound, at best (1 + step) times as high.

    ``point`` is moved along with the attained value. Where the search comes to no end the bound is
    raised, by more every time, and in the end given up.
    """
    sought = (1 + step) * max(attained, _SMALLEST)
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


def _result(
    name: tuple[str, str, str],
    attained: float,
    at: Point | None,
    proved: float,
    tolerance: float,
    boxes: int,
) -> Bound:
    closed = proved == attained or proved <= (1 + tolerance) * max(attained, _SMALLEST) * (1 + 1e-9)
    if name[2] == "disk_margin":  # α = 1/max |S − T|/2
        attained, proved = 1 / attained, 1 / proved
    return Bound(*name, attained, at, proved, bool(closed), boxes)
