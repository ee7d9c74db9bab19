"""Stability of a whole box: proved, or refuted by a witness.

Closed-loop poles move continuously with the plant, those far from the origin included, since the
loop gain is small there. A box is therefore stable if one of its plants is, by the certain count of
encirclements (or by the multipliers of the loop as it runs), and no plant of the box has a
closed-loop pole on the imaginary axis: the figure's denominator has no zero. A box that holds the
boundary of stability has no such proof, so that its corners are asked first; where the proof gets
stuck it has found the boundary, and plants to either side of it are asked.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from mptune.certify.enclosure import DELAY, OMEGA, RATIO, TAU_A, TAU_B
from mptune.certify.form import curve_of, form_of
from mptune.certify.problem import Interval, Point, edges_of, plants_of
from mptune.certify.proof import Proof
from mptune.certify.result import BoxStability, Stability
from mptune.certify.search import PROVED
from mptune.certify.tails import tail_start
from mptune.loops.broken import FORCE, SAMPLED, VELOCITY
from mptune.loops.family import FamilyLoops
from mptune.loops.sampled import stable_as_sampled
from mptune.loops.stability import count_unstable_poles

if TYPE_CHECKING:
    from mptune.arrays import BoolArray, FloatArray
    from mptune.certify.form import Form
    from mptune.certify.problem import BoxedLoop
    from mptune.params.packed import Plants

BUDGET = 300_000  # boxes
_LITTLE = 20_000
_END = 10.0  # S is below it where the proof ends: some number above 1
TERMS = 6  # K of a sampled loop
_ROUNDED = 1e-12  # relative: nearer to an end of its interval a value is that end
_ASIDE = (0.0, 1e-4, 1e-3, 1e-2, 0.1)  # of the way to a corner: where a witness is looked for


def stable_plants(
    problem: BoxedLoop, plants: Plants, path: str, loop: str = "force_reference"
) -> tuple[BoolArray, BoolArray]:
    """Return ``(N,)`` whether the loops of single plants are stable, and whether that is sure.

    ``loop`` is ``"velocity"`` for the velocity loop alone; any other name stands for the whole.
    """
    if path == "sampled":
        return stable_as_sampled(
            FamilyLoops(plants, problem.gains, problem.filters), problem.period
        )
    which = VELOCITY if loop == "velocity" else FORCE
    loops = FamilyLoops(plants, problem.gains, problem.path(path), which)
    count = count_unstable_poles(loops)
    return count.stable, count.decided


def box_stability(
    problem: BoxedLoop, path: str, loop: str = "force_reference", budget: int = BUDGET
) -> BoxStability:
    """Prove the loops of all plants of the box stable, or find one that is not.

    Parameters
    ----------
    problem
        The box and the loop.
    path
        ``"none"``, ``"filters"`` or ``"sampled"``.
    loop
        ``"velocity"`` for the velocity loop alone; any other name stands for the whole.
    budget
        Boxes to try at most.
    """
    problem = problem.along(path)
    loop = loop if loop == "velocity" else "force_reference"
    corners, known = corner_verdict(problem, path, loop)
    if corners is not None or not known:
        return verdict(loop, path, corners, None, 0)
    return verdict_from(problem, problem, path, loop, budget)


def verdict_from(
    inside: BoxedLoop, hull: BoxedLoop, path: str, loop: str, budget: int
) -> BoxStability:
    """Return the verdict on a box, given that some plant of a ``hull`` about it is stable.

    The proof is tried on the hull, with little effort before the corners of the box ``inside`` are
    asked and with all of it after that.
    """
    form = form_of(hull, loop, path, "sensitivity_peak")
    edges = edges_of(hull, (0.0, axis_end(hull, form)))
    proof = Proof(form, curve_of(1.0), edges, TERMS)
    for effort in (min(_LITTLE, budget), budget):
        if proof.run_nonzero(effort) == PROVED:
            return BoxStability(loop, path, Stability.STABLE, None, None, proof.boxes)
        witness, _ = corner_verdict(inside, path, loop)
        if witness is not None:
            return verdict(loop, path, witness, None, proof.boxes)
    witness = witness_near(inside, proof.point, path, loop)
    return verdict(loop, path, witness, point_of(inside, proof.point), proof.boxes)


def axis_end(problem: BoxedLoop, form: Form) -> float:
    """Return the frequency [rad/s] beyond which no loop of the box comes near −1."""
    if form.loop == SAMPLED:
        return float(np.pi / form.period)
    return tail_start(form, edges_of(problem, (0.0, 0.0))[1, RATIO], _END)


def verdict(
    loop: str, path: str, witness: Point | None, suspect: Point | None, boxes: int
) -> BoxStability:
    """Return a box that is unstable where there is a witness, else undecided."""
    if witness is None:
        return BoxStability(loop, path, Stability.UNDECIDED, None, suspect, boxes)
    return BoxStability(loop, path, Stability.UNSTABLE, witness, None, boxes)


@lru_cache(maxsize=512)
def corner_verdict(problem: BoxedLoop, path: str, loop: str) -> tuple[Point | None, bool]:
    """Return an unstable corner of the box, if any, and whether some corner is surely stable."""
    corners = problem.box.corners(problem.share_a)
    stable, decided = stable_plants(problem, corners, path, loop)
    return first_unstable(corners, stable, decided), bool(stable.any())


def first_unstable(plants: Plants, stable: BoolArray, decided: BoolArray) -> Point | None:
    """Return one of the plants that is surely unstable, if any."""
    bad = np.flatnonzero(decided & ~stable)
    if len(bad) == 0:
        return None
    mass, delay, tau_a, tau_b, _ = (float(column[bad[0]]) for column in plants)
    return Point(mass, delay, tau_a, tau_b, float("nan"))


def point_of(problem: BoxedLoop, place: FloatArray) -> Point:
    """Return a place in coordinates as a plant of the box and a frequency.

    What lies at an end of its interval but for rounding is put there.
    """
    box = problem.box
    values = (box.nominal.mass / place[RATIO], place[DELAY], place[TAU_A], place[TAU_B])
    sides = (box.mass, box.delay, box.tau_a, box.tau_b)
    mass, delay, tau_a, tau_b = (
        _inside(float(one), side) for one, side in zip(values, sides, strict=True)
    )
    return Point(mass, delay, tau_a, tau_b, float(place[OMEGA]))


def _inside(value: float, side: Interval) -> float:
    for end in side:
        if abs(value - end) <= _ROUNDED * end:
            return end
    return min(max(value, side[0]), side[1])


def witness_near(problem: BoxedLoop, place: FloatArray, path: str, loop: str) -> Point | None:
    """Return an unstable plant of the box beside a place on the boundary of stability, if any."""
    at = np.array(point_of(problem, place)[:4])
    box = problem.box
    sides = (box.mass, box.delay, box.tau_a, box.tau_b)
    rows = [
        at + share * (np.array(corner) - at)
        for share, corner in product(_ASIDE, product(*(sorted(set(side)) for side in sides)))
    ]
    plants = plants_of(rows, problem.share_a)
    stable, decided = stable_plants(problem, plants, path, loop)
    return first_unstable(plants, stable, decided)
