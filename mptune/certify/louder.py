"""The gain margin around a state estimator, where the gain is no mass divided by a factor.

The force that the estimator hears knows nothing of the mass, so that lighter plants do not stand
for a higher gain. The gain is then a coordinate of the box: no plant, at no gain from 1 to a
factor, has a closed-loop pole on the imaginary axis, if 1 + L has no zero over the box so
lengthened; and the box being stable as it is, it is stable at that factor. From above comes the
least margin of single plants: of the box's corners, and of wherever a proof got stuck.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from mptune.certify.form import curve_of, form_of
from mptune.certify.problem import Point, edges_of, plants_of
from mptune.certify.proof import Proof
from mptune.certify.result import Bracket
from mptune.certify.sampled import ESTIMATED_TERMS
from mptune.certify.search import PROVED
from mptune.certify.stability import axis_end, point_of, stable_plants

if TYPE_CHECKING:
    from mptune.certify.problem import BoxedLoop
    from mptune.params.packed import LoopGains

_LARGEST = 1024.0  # beyond it nothing is asked
_FARTHER = 3.0  # times as far below a plant's margin, where a proof did not come about
_LEAST = 1.02  # nothing is proved below it
_ONE_PLANT = 1e-6  # to which a single plant's margin is found, relative


def gain_margin(problem: BoxedLoop, path: str, tolerance: float, budget: int) -> Bracket:
    """Return the gain margin of the loop at F_ref, given that the box is stable as it is.

    Parameters
    ----------
    problem, path
        The box and the loop; ``"estimator"`` or ``"sampled"``.
    tolerance
        How far apart both ends of the bracket may be, relative to the lower one.
    budget
        Boxes per proof.
    """
    upper, boxes = _LARGEST, 0
    at: Point | None = None
    corners = problem.box.corners(problem.share_a)
    for mass, delay, tau_a, tau_b, _ in zip(*corners, strict=True):
        corner = Point(float(mass), float(delay), float(tau_a), float(tau_b), math.nan)
        upper, at = _lower_of(problem, path, upper, at, corner)
    apart, lower = tolerance / 2, 1.0
    while (asked := upper / (1 + apart)) > _LEAST:
        status, place, taken = _proved(problem, path, asked, budget)
        boxes += taken
        if status == PROVED:
            lower = asked
            break
        before = upper
        upper, at = _lower_of(problem, path, upper, at, place)
        apart = _FARTHER * apart if upper == before else apart
    if upper >= _LARGEST:
        upper = math.inf
    return Bracket(lower, upper, at, upper <= (1 + tolerance) * lower, boxes)


def bears(problem: BoxedLoop, path: str, factor: float, budget: int) -> bool:
    """Return whether it is proved that no plant turns unstable as its gain rises by a factor.

    Parameters
    ----------
    problem, path
        As of ``gain_margin``.
    factor
        The factor, above 1.
    budget
        Boxes to try at most.
    """
    return _proved(problem.along(path), path, factor, budget)[0] == PROVED


def _proved(problem: BoxedLoop, path: str, factor: float, budget: int) -> tuple[int, Point, int]:
    """Try to prove that no gain up to a factor makes a plant unstable; return where that ended."""
    louder = replace(problem, gains=_scaled(problem, factor))
    end = axis_end(louder, form_of(louder, "force_reference", path, "sensitivity_peak"))
    form = form_of(problem, "force_reference", path, "sensitivity_peak")
    edges = edges_of(problem, (0.0, end), gain=factor)
    proof = Proof(form, curve_of(1.0), edges, ESTIMATED_TERMS)
    status = proof.run_nonzero(budget)
    return status, point_of(problem, proof.point), proof.boxes


def _lower_of(
    problem: BoxedLoop, path: str, upper: float, at: Point | None, place: Point
) -> tuple[float, Point | None]:
    """Return the lower of a margin known and of one plant's, each with its plant."""
    own = _own_margin(problem, path, place, upper)
    return (own, place) if own < upper else (upper, at)


def _scaled(problem: BoxedLoop, factor: float) -> LoopGains:
    return problem.gains._replace(k_p_vel=factor * problem.gains.k_p_vel)


def _own_margin(problem: BoxedLoop, path: str, at: Point, limit: float) -> float:
    """Return the factor at which one plant of the box is certainly unstable, if below a limit."""
    plant = plants_of([at[:4]], problem.share_a)

    def unstable(factor: float) -> bool:
        scaled = replace(problem, gains=_scaled(problem, factor))
        stable, decided = stable_plants(scaled, plant, path)
        return bool(decided[0] and not stable[0])

    low, high = 1.0, min(2.0, limit)
    while not unstable(high):
        if high >= limit:
            return math.inf
        low, high = high, min(2 * high, limit)
    while high > low * (1 + _ONE_PLANT):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if unstable(middle) else (middle, high)
    return high
