"""What is guaranteed of a study's linear model, over its whole continuous box.

A grid can only miss; ``mptune.certify`` does not. Measured responses are known at their points
only: where they stand in the box's place nothing is certified, where they stand beside it the
certificates are the box's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from mptune.certify.bounds import BUDGET, TOLERANCE, aimed, bound
from mptune.certify.louder import bears
from mptune.certify.margins import margin
from mptune.certify.problem import BoxedLoop
from mptune.certify.radius import radius
from mptune.certify.result import Grounds
from mptune.certify.stability import box_stability
from mptune.robust.place import PlantPoint, finite
from mptune.summary import Summarised

if TYPE_CHECKING:
    from mptune.certify.problem import Point
    from mptune.certify.result import Bound, BoxStability, Bracket
    from mptune.params.packed import LoopGains
    from mptune.params.requirements import RatioCurve
    from mptune.robust.model import LinearModel

_FINEST = 1e-6  # tolerance at which a limit that lies between both bounds is given up
EQUATION_OF = {"velocity": "equation_17", "position": "equation_21"}
PEAKS = ("sensitivity_peak", "complementary_peak")
RADII = {  # key in JSON, and what fails
    "equation_17": "equation_17",
    "equation_21": "equation_21",
    "true": "none",
    "with_path": "filters",  # or the state estimator
    "sampled": "sampled",
}


@dataclass(frozen=True, repr=False)
class Certificates(Summarised):
    """Bounds over the whole box for one set of gains.

    Attributes
    ----------
    problem
        The box and the loop.
    bounds
        Attained and guaranteed worst cases: Eq. 17 and Eq. 21 with the study's measurement path, S
        and T of the velocity and the position loop without and with it, and S, T and disk margin
        at F_ref without it, with it and sampled.
    stability
        Of all plants of the box: the velocity loop with the study's measurement path, then the
        whole loop without, with and sampled.
    radii
        By the keys of ``RADII``, the factor by which the box may grow; empty where not asked for.
    """

    problem: BoxedLoop
    bounds: tuple[Bound, ...]
    stability: tuple[BoxStability, ...]
    radii: dict[str, Bracket] = field(default_factory=dict)

    @property
    def headline(self) -> str:
        """How many of the bounds are closed."""
        closed = sum(one.closed for one in self.bounds)
        return f"{closed} of {len(self.bounds)} bounds closed"

    def of(self, loop: str, path: str, figure: str) -> Bound | None:
        """Return one bound; None where it was not asked for."""
        wanted = loop, path, figure
        found = (one for one in self.bounds if (one.loop, one.path, one.figure) == wanted)
        return next(found, None)

    def stable(self, loop: str, path: str) -> BoxStability | None:
        """Return the stability of one loop; None where it was not asked for."""
        found = (one for one in self.stability if (one.loop, one.path) == (loop, path))
        return next(found, None)

    def json(self) -> dict[str, Any]:
        """Return the bounds in SI, None where they are infinite."""
        values: dict[str, Any] = {
            "bounds": [
                {
                    "loop": one.loop,
                    "path": one.path,
                    "figure": one.figure,
                    **bound_json(one),
                    "at": _values(one.at),
                }
                for one in self.bounds
            ],
            "stability": [
                {
                    "loop": one.loop,
                    "path": one.path,
                    "status": one.status.value,
                    "witness": _values(one.witness),
                }
                for one in self.stability
            ],
        }
        if self.radii:
            values["radius"] = {
                name: [finite(one.lower), finite(one.upper)] for name, one in self.radii.items()
            }
        return values


def bound_json(one: Bound) -> dict[str, Any]:
    """Return attained value and bound, as JSON has them."""
    return {"attained": finite(one.attained), "bound": finite(one.bound), "closed": one.closed}


def certified_problem(model: LinearModel, gains: LoopGains) -> BoxedLoop | None:
    """Return the box and the loop; None where measured responses stand in the box's place."""
    if model.members is not None and model.members.instead:
        return None
    return replace(BoxedLoop.of(model.study), gains=gains)


def certify(model: LinearModel, gains: LoopGains) -> Certificates | None:
    """Return what is guaranteed over the box; None where measured responses stand in its place."""
    problem = certified_problem(model, gains)
    if problem is None:
        return None
    paths = (*model.paths, *(("sampled",) if model.runs else ()))
    named = [(loop, model.path_name, equation) for loop, equation in EQUATION_OF.items()]
    named += [
        (loop, path, peak)
        for loop in ("velocity", "position", "force_reference")
        for path in paths
        for peak in PEAKS
        if path not in {"estimator", "sampled"} or loop == "force_reference"
    ]
    named += [("force_reference", path, "disk_margin") for path in paths]
    named += [("force_reference", path, "peak_compliance") for path in paths if path == "sampled"]
    bounds = tuple(bound(problem, *name) for name in named)
    asked = [("velocity", model.path_name), *(("force_reference", path) for path in paths)]
    stability = tuple(box_stability(problem, path, loop) for loop, path in asked)
    return Certificates(problem, bounds, stability)


def radii_of(certificates: Certificates, path: str, tolerance: float = 1e-2) -> dict[str, Bracket]:
    """Return the factors by which the box may grow, by the keys of ``RADII``.

    ``path`` is that of the study's inequalities; the brackets are closed to ``tolerance``.
    """
    problem = certificates.problem
    wanted = [name for name in RADII if name != "sampled" or problem.holds_sampled]
    fails = RADII | {"with_path": problem.measured}
    return {name: radius(problem, fails[name], path=path, tolerance=tolerance) for name in wanted}


def against(problem: BoxedLoop, found: Bound, limit: float) -> tuple[Bound, Grounds]:
    """Return a bound fine enough to tell on which side of a limit the figure lies, if it can be.

    The limit is the largest allowed, for a disk margin the smallest.
    """
    name, tolerance = (found.loop, found.path, found.figure), TOLERANCE
    if math.isinf(found.gap):  # given up: a finer one is harder yet
        tolerance = 0.0
    if _astride(found, limit) and found.path == "sampled" and problem.measured == "estimator":
        found, tolerance = aimed(problem, found, limit), 0.0  # finer ones close nothing there
    while _astride(found, limit) and tolerance > _FINEST:
        tolerance = max(tolerance / 10, _FINEST)
        found = bound(problem, *name, tolerance=tolerance)
    return found, Grounds.OPEN if _astride(found, limit) else Grounds.CERTIFIED


def _astride(found: Bound, limit: float) -> bool:
    low, high = sorted((found.attained, found.bound))
    return low <= limit < high if found.figure != "disk_margin" else low < limit <= high


def use_of_curve(problem: BoxedLoop, name: tuple[str, str, str], curve: RatioCurve) -> Bound:
    """Return the largest quotient of a ratio and what a curve over frequency allows."""
    used = bound(problem, *name, allowed=curve)
    tolerance = TOLERANCE
    while _astride(used, 1.0) and tolerance > _FINEST:
        tolerance = max(tolerance / 10, _FINEST)
        used = bound(problem, *name, allowed=curve, tolerance=tolerance)
    return used


def margin_against(problem: BoxedLoop, name: str, limit: float) -> tuple[Bracket, Grounds]:
    """Return a margin's bracket at F_ref as it runs, closed until a limit lies outside it."""
    tolerance = 1e-2
    found = margin(problem, "sampled", name, tolerance=tolerance)
    estimated = name == "gain_margin" and problem.measured == "estimator"
    if estimated and 0 < found.lower < limit <= found.upper:
        proved = bears(problem, "sampled", limit, BUDGET)
        found, tolerance = replace(found, lower=limit) if proved else found, 0.0
    while found.lower < limit <= found.upper and tolerance > _FINEST:
        tolerance = max(tolerance / 30, _FINEST)
        found = margin(problem, "sampled", name, tolerance=tolerance)
    return found, Grounds.OPEN if found.lower < limit <= found.upper else Grounds.CERTIFIED


def place_of(at: Point | None) -> PlantPoint | None:
    """Return a place of a certificate as results name it; no frequency where there is none."""
    if at is None:
        return None
    return PlantPoint(at.mass, at.delay, at.tau_a, at.tau_b, at.omega)


def _values(at: Point | None) -> dict[str, Any] | None:
    place = place_of(at)
    return None if place is None else place.values()
