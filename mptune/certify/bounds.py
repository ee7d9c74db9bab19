"""Attained and guaranteed worst cases of one figure over a box."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from mptune.certify.ascent import SMALLEST, attain, close, terms_of
from mptune.certify.climb import SINGULAR
from mptune.certify.form import (
    COMPLIANCE,
    EQUATION_17,
    EQUATION_21,
    MIXTURE,
    Curve,
    curve_of,
    form_of,
    scale_of,
)
from mptune.certify.problem import edges_of, plants_of
from mptune.certify.proof import Proof
from mptune.certify.result import Bound
from mptune.certify.sampled import ESTIMATED_TERMS
from mptune.certify.search import PROVED
from mptune.certify.stability import corner_verdict, point_of, stable_plants, witness_near
from mptune.loops.broken import POSITION, SAMPLED

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.certify.form import Form
    from mptune.certify.problem import BoxedLoop, Point

TOLERANCE = 1e-3  # ε
FOLDED = 1e-2  # ε of the loop as it runs around a state estimator: see ``folded``
BUDGET = 1_000_000  # boxes, at most, before a bound is given up for a higher one
_LITTLE = 50_000  # boxes where nothing would rest on the bound


def bound(
    problem: BoxedLoop,
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
        ``"none"``, ``"filters"`` or ``"estimator"``, or ``"sampled"`` for the loop at F_ref as it
        runs.
    figure
        ``"equation_17"``, ``"equation_21"``, ``"sensitivity_peak"``, ``"complementary_peak"``,
        ``"disk_margin"`` or, of the loop at F_ref, ``"peak_compliance"``, |S|/(mω²) [m/N].
    tolerance
        How far apart both may be, relative to the attained value; at least ``FOLDED`` where folds
        are left out.
    allowed
        The largest allowed ratio of an equation, a number or a curve over frequency: the figure is
        then what a plant uses of it.
    budget
        Boxes to try at most. Little of it is spent where nothing would rest on the bound: where no
        loop that the figure asks to be stable is known to be so.

    Returns
    -------
    Bound
        Both values; infinite where the box holds a plant whose loop is unstable.

    Raises
    ------
    ValueError
        If there is no such figure of that loop with that path.
    """
    problem = problem.along(path)
    form = form_of(problem, loop, path, figure)
    if form.loop == SAMPLED and form.path.estimator_mass > 0:
        tolerance = max(tolerance, FOLDED)
    name = loop, path, figure
    witness, known = _corner_witness(problem, form, loop, path)
    if witness is not None:
        return _result(name, math.inf, witness, math.inf, tolerance, 0)
    if form.figure == COMPLIANCE and _open(form):
        return _result(name, math.inf, None, math.inf, tolerance, 0)
    if _no_loop(form):
        value = 2.0 if figure == "disk_margin" else form.share_s
        return Bound(loop, path, figure, value, None, value, closed=True, boxes=0)
    curve = curve_of(allowed)
    if not (known and _premised(problem, form, path)):
        budget = min(budget, _LITTLE)
    attained, point, edges = attain(problem, form, curve, tolerance)
    terms = terms_of(form, edges, attained, point, tolerance)
    proof = Proof(form, curve, edges, terms)
    attained, proved = close(proof, attained, point, tolerance, budget)
    at = point_of(problem, point)
    if attained >= SINGULAR or not math.isfinite(proved):
        witness = _witness_near(problem, form, point, loop, path)
        if witness is not None:
            return _result(name, math.inf, witness, math.inf, tolerance, proof.boxes)
    found = _result(name, attained, at, proved, tolerance, proof.boxes)
    if form.figure == COMPLIANCE:
        scale = scale_of(form)
        found = replace(found, attained=scale * attained, bound=scale * proved * (1 + 1e-15))
    return found if known else replace(found, closed=False)


def aimed(problem: BoxedLoop, found: Bound, limit: float, *, budget: int = BUDGET) -> Bound:
    """Return a bound whose guaranteed value is a limit, where that is proved; else as it was.

    Around a state estimator what folds leave out keeps attained and guaranteed value apart, and a
    guaranteed value is one of few that were tried. Whether a limit between them holds is a question
    of its own, and one proof.

    Parameters
    ----------
    problem, found
        The box and the loop, and what ``bound`` found of it.
    limit
        The largest value that is asked about, for a disk margin the smallest.
    budget
        Boxes to try at most.
    """
    problem = problem.along(found.path)
    form = form_of(problem, found.loop, found.path, found.figure)
    if form.loop != SAMPLED or form.path.estimator_mass == 0 or not math.isfinite(found.bound):
        return found
    sought = 1 / limit if found.figure == "disk_margin" else limit
    if form.figure == COMPLIANCE:
        sought /= scale_of(form)
    edges = edges_of(problem, (0.0, math.pi / form.period))
    proof = Proof(form, curve_of(1.0), edges, ESTIMATED_TERMS)
    proved = proof.run(sought * (1 - 1e-12), budget) == PROVED  # less than any rounding of it
    bounded = limit if proved else found.bound
    return replace(found, bound=bounded, boxes=found.boxes + proof.boxes)


def _no_loop(form: Form) -> bool:
    """Return whether there is no position loop: then S = 1, T = 0 and Eq. 21's ratio is 0."""
    position = form.figure == EQUATION_21 or (form.figure == MIXTURE and form.loop == POSITION)
    return position and _open(form)


def _open(form: Form) -> bool:
    """Return whether the position is not fed back: the least load then moves it without end."""
    return form.gains.k_p_pos == 0 and form.gains.k_i_pos == 0


def _corner_witness(
    problem: BoxedLoop, form: Form, loop: str, path: str
) -> tuple[Point | None, bool]:
    """Return a corner of the box that makes the figure infinite, if any, and whether that is known.

    An S, a T or a margin of an unstable loop is none; that none of the box is unstable follows from
    the bound, if one corner is surely stable. Eq. 21 is infinite where the velocity loop of a plant
    has a pole on the imaginary axis: between a stable corner and an unstable one.
    """
    if form.figure == EQUATION_17:
        return None, True
    witness, some_stable = corner_verdict(problem, path, _asked(form, loop))
    if form.figure in {MIXTURE, COMPLIANCE}:
        return witness, some_stable
    return witness if some_stable else None, True


def _premised(problem: BoxedLoop, form: Form, path: str) -> bool:
    """Return whether what an equation takes for granted is known: stable nominal loops.

    Eq. 21 asks besides that no velocity loop is unstable, of which one corner has to be sure.
    """
    if form.figure not in {EQUATION_17, EQUATION_21}:
        return True
    nominal = problem.box.nominal
    plant = plants_of([nominal.mass, nominal.delay, 0.0, 0.0], problem.share_a)
    asked = ("velocity",) if form.figure == EQUATION_17 else ("velocity", "force_reference")
    if not all(stable_plants(problem, plant, path, loop)[0][0] for loop in asked):
        return False
    return form.figure == EQUATION_17 or corner_verdict(problem, path, "velocity")[1]


def _witness_near(
    problem: BoxedLoop, form: Form, place: FloatArray, loop: str, path: str
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


def _result(
    name: tuple[str, str, str],
    attained: float,
    at: Point | None,
    proved: float,
    tolerance: float,
    boxes: int,
) -> Bound:
    closed = proved == attained or proved <= (1 + tolerance) * max(attained, SMALLEST) * (1 + 1e-9)
    if name[2] == "disk_margin":  # α = 1/max |S − T|/2
        attained, proved = 1 / attained, 1 / proved
    return Bound(*name, attained, at, proved, bool(closed), boxes)
