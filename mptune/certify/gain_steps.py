"""The gain margin around a state estimator, where the gain is no mass divided by a factor.

The force that the estimator hears knows nothing of the mass, so that lighter plants do not stand
for a higher gain. At a gain g, a factor f more of it moves 1 + L by (f − 1)L, and no plant whose
|T| is below γ meets −1 while (f − 1)γ < 1: from one proof follows stability up to g(1 + 1/γ), and
so on, in steps that end at the margin. γ is well above what is attained, so that proofs are cheap.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from mptune.certify.ascent import attain
from mptune.certify.climb import figure_at
from mptune.certify.form import curve_of, form_of
from mptune.certify.problem import plants_of
from mptune.certify.proof import Proof
from mptune.certify.result import Bracket
from mptune.certify.sampled import ESTIMATED_TERMS
from mptune.certify.search import ABOVE, PROVED
from mptune.certify.stability import point_of, stable_plants

if TYPE_CHECKING:
    from mptune.certify.problem import BoxedLoop, Point
    from mptune.params.packed import LoopGains

_MOST_STEPS = 12
_LARGEST = 1024.0  # beyond it nothing is asked
_CARE = 1 - 1e-9
_COARSE = 1.5  # times the attained |T|: what is proved


def gain_margin(problem: BoxedLoop, path: str, tolerance: float, budget: int) -> Bracket:
    """Return the gain margin of the loop at F_ref, given that the box is stable as it is.

    Parameters
    ----------
    problem, path
        The box and the loop; ``"estimator"`` or ``"sampled"``.
    tolerance
        How far apart both ends of the bracket may be, relative to the lower one.
    budget
        Boxes per step.
    """
    lower, upper, boxes = 1.0, math.inf, 0
    at: Point | None = None
    for _ in range(_MOST_STEPS):
        here = replace(problem, gains=_scaled(problem, lower))
        form = form_of(here, "force_reference", path, "complementary_peak")
        peak, place, edges = attain(here, form, curve_of(1.0), _COARSE)
        proof = Proof(form, curve_of(1.0), edges, ESTIMATED_TERMS)
        status = ABOVE
        while status == ABOVE:
            sought = _COARSE * max(peak, 1.0)
            own = _own_margin(problem, path, point_of(problem, place))
            if own < upper:
                upper, at = own, point_of(problem, place)
            status = proof.run(sought, budget)
            place = proof.point.copy()
            peak = max(float(figure_at(form, curve_of(1.0), place)), peak)
        boxes += proof.boxes
        if status != PROVED or lower > _LARGEST:
            break
        lower *= 1 + _CARE / sought
        if upper <= (1 + tolerance) * lower:
            break
    lower = min(lower, upper)
    return Bracket(lower, upper, at, upper <= (1 + tolerance) * lower, boxes)


def _scaled(problem: BoxedLoop, factor: float) -> LoopGains:
    return problem.gains._replace(k_p_vel=factor * problem.gains.k_p_vel)


def _own_margin(problem: BoxedLoop, path: str, at: Point) -> float:
    """Return the factor at which one plant of the box is certainly unstable."""
    plant = plants_of([at[:4]], problem.share_a)

    def unstable(factor: float) -> bool:
        scaled = replace(problem, gains=_scaled(problem, factor))
        stable, decided = stable_plants(scaled, plant, path)
        return bool(decided[0] and not stable[0])

    low, high = 1.0, 2.0
    while not unstable(high):
        low, high = high, 2 * high
        if low > _LARGEST:
            return math.inf
    while high > low * (1 + 1e-5):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if unstable(middle) else (middle, high)
    return high
