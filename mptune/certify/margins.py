"""Gain, phase and delay margin of the loop at F_ref over a whole box, each in a bracket.

A gain margin is a mass divided by the factor, as the loop gain is K_P,vel/m times a rest: the box
is extended by lighter plants; around a state estimator it is not, see ``louder``. A delay
margin is more delay in the box. A phase margin is one side of the box more, the extra phase φ
within ±φ_m: no plant's loop, turned by any of these, meets −1.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from mptune.certify.bracket import bracket
from mptune.certify.climb import gain_at
from mptune.certify.enclosure import OMEGA, PHASE, SIDES
from mptune.certify.form import curve_of, form_of
from mptune.certify.louder import gain_margin
from mptune.certify.problem import edges_of
from mptune.certify.proof import Proof
from mptune.certify.result import Bracket, Stability
from mptune.certify.search import PROVED
from mptune.certify.stability import (
    TERMS,
    axis_end,
    box_stability,
    point_of,
    verdict_from,
)

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.certify.form import Form
    from mptune.certify.problem import BoxedLoop, Point

MARGINS = ("gain_margin", "phase_margin", "delay_margin")
TOLERANCE = 1e-2
_BUDGET = 300_000  # boxes per step
_LARGEST_GAIN, _LONGEST_DELAY = 1024.0, 10.0  # s: beyond them nothing is asked
_SHORTEST_DELAY = 1e-7  # s
_SMALLEST_PHASE = 1e-4  # rad
_SCAN = 240  # frequencies per plant
_BISECTIONS = 50


def margin(
    problem: BoxedLoop,
    path: str,
    name: str,
    *,
    tolerance: float = TOLERANCE,
    budget: int = _BUDGET,
) -> Bracket:
    """Return a margin of the loop at F_ref that all plants of the box have.

    Parameters
    ----------
    problem
        The box and the loop.
    path
        ``"none"``, ``"filters"`` or ``"sampled"``.
    name
        ``"gain_margin"`` (a factor above 1), ``"phase_margin"`` [rad], the smaller of both
        directions, or ``"delay_margin"`` [s].
    tolerance
        How far apart both ends of the bracket may be, relative to the lower one.
    budget
        Boxes per step.

    Returns
    -------
    Bracket
        Guaranteed and attained margin; 0 to 0 where the box holds an unstable plant.
    """
    problem = problem.along(path)
    whole = box_stability(problem, path, budget=budget)
    if whole.status is not Stability.STABLE:
        unstable = whole.status is Stability.UNSTABLE
        upper = 0.0 if unstable else math.inf
        return Bracket(0.0, upper, whole.witness, unstable, whole.boxes)
    if name == "phase_margin":
        return _phase_margin(problem, path, tolerance, budget)
    if name == "gain_margin" and path != "none" and problem.filters.estimator_mass > 0:
        return gain_margin(problem, path, tolerance, budget)
    box = problem.box

    def verdict(value: float, _lower: float) -> tuple[Stability, Point | None, int]:
        if name == "gain_margin":
            wider = replace(box, mass=(box.mass[0] / value, box.mass[1]))
        else:
            wider = replace(box, delay=(box.delay[0], box.delay[1] + value))
        inside = replace(problem, box=wider)
        found = verdict_from(inside, inside, path, "force_reference", budget)
        return found.status, found.witness, found.boxes

    if name == "gain_margin":
        found = bracket(verdict, 2.0, tolerance, 1.0, _LARGEST_GAIN)
        at = found.at and found.at._replace(mass=max(found.at.mass * found.upper, box.mass[0]))
        return replace(found, lower=max(found.lower, 1.0), at=at)
    start = max(box.delay[1], problem.period)
    found = bracket(verdict, start, tolerance, _SHORTEST_DELAY, _LONGEST_DELAY)
    at = found.at and found.at._replace(delay=max(found.at.delay - found.upper, box.delay[0]))
    return replace(found, at=at)


def _phase_margin(problem: BoxedLoop, path: str, tolerance: float, budget: int) -> Bracket:
    """Return the phase margin: the least of single plants, and a proof a little below it."""
    form = form_of(problem, "force_reference", path, "sensitivity_peak")
    end = axis_end(problem, form)
    plants = list(np.unique(_corners(edges_of(problem, (0.0, end))), axis=0))
    found = [(own_phase_margin(form, plant, end), plant) for plant in plants]
    upper, place = min(found, key=lambda one: one[0])
    asked, lower, boxes = upper / (1 + tolerance / 2), 0.0, 0
    while asked > _SMALLEST_PHASE:
        proof = Proof(form, curve_of(1.0), edges_of(problem, (0.0, end), asked), TERMS)
        status = proof.run_nonzero(budget)
        boxes += proof.boxes
        if status == PROVED:
            lower = asked
            break
        own = own_phase_margin(form, proof.point, end)
        if own < upper:
            upper, place = own, proof.point.copy()
        asked = min(0.9 * asked, upper / (1 + tolerance / 2))
    at = point_of(problem, place)
    return Bracket(lower, upper, at, upper <= (1 + tolerance) * lower, boxes)


def _corners(edges: FloatArray) -> FloatArray:
    grid = np.meshgrid(*(edges[:, i] for i in range(1, SIDES)), indexing="ij")
    corners = np.stack([np.zeros(grid[0].size), *(axis.ravel() for axis in grid)], axis=1)
    corners[:, PHASE] = 0.0
    return corners


def own_phase_margin(form: Form, plant: FloatArray, end: float) -> float:
    """Return one plant's phase margin [rad], its frequency left in ``plant``; π if it has none."""
    place = plant.copy()
    place[PHASE] = 0.0

    def gain(omega: float) -> complex:
        place[OMEGA] = omega
        return complex(gain_at(form, place))

    omega = [float(one) for one in end * np.geomspace(1e-4, 1.0, _SCAN)]
    above = [abs(gain(one)) > 1 for one in omega]
    least = math.pi
    for k in range(_SCAN - 1):
        if above[k] == above[k + 1]:
            continue
        low, high = omega[k], omega[k + 1]
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if (abs(gain(middle)) > 1) == above[k] else (low, middle)
        phase = abs(cmath.phase(-gain(low)))
        if phase < least:
            least = phase
            plant[OMEGA] = low
    return least
