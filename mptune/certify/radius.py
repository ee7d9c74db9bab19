"""By what factor the box may grow about the nominal plant: conservatism as a number.

The grown box is x_N + ρ(x − x_N) in m, d, τ_A and τ_B, with τ_N = 0; masses stay above a small
positive one, delays and time constants at or above 0, and the total delay of the loop as it runs at
or above T_S/2. Proofs go from factor to factor: what is proved next is the least box that holds two
grown boxes, and all between them with it, wherever the nominal plant lies. The first is the nominal
plant, or where the proof cannot come away from it, as around an estimator where τ vanishes, the box
itself. What fails, fails in a grown box.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from mptune.certify.ascent import attain
from mptune.certify.bracket import bracket
from mptune.certify.enclosure import RATIO
from mptune.certify.form import curve_of, form_of
from mptune.certify.problem import edges_of, plants_of
from mptune.certify.proof import Proof
from mptune.certify.result import Bracket, Stability
from mptune.certify.search import PROVED
from mptune.certify.stability import point_of, stable_plants, verdict_from
from mptune.certify.tails import tail_start

if TYPE_CHECKING:
    from mptune.certify.problem import BoxedLoop, Point

RADII = ("equation_17", "equation_21", "none", "filters", "estimator", "sampled")
TOLERANCE = 1e-2
LARGEST = 128.0  # factors above it are not asked about
_LEAST = 1e-3  # nor are factors below it
_BUDGET = 300_000  # boxes per factor


def radius(
    problem: BoxedLoop,
    until: str,
    *,
    path: str = "none",
    tolerance: float = TOLERANCE,
    budget: int = _BUDGET,
) -> Bracket:
    """Return how far the box may grow until something fails.

    Parameters
    ----------
    problem
        The box and the loop.
    until
        ``"equation_17"`` or ``"equation_21"``: until the ratio of that equation, with the
        measurement path ``path``, reaches 1; another path: until the true loop with it is unstable.
    path
        ``"none"`` or ``"filters"``, of the equations.
    tolerance
        How far apart both ends of the bracket may be, relative to the lower one.
    budget
        Boxes per factor.

    Raises
    ------
    ValueError
        If the loop as it runs is asked for and some delay is below T_S/2.
    """
    if until == "sampled" and not problem.holds_sampled:
        raise ValueError("some delay is below T_S/2: as it runs, no hold fits into it")
    floor = problem.period / 2 if until == "sampled" else 0.0
    equation = until.startswith("equation")
    problem = problem.along(path if equation else until)
    if not equation and not _nominal_stable(problem, until, floor):
        return Bracket(0.0, 0.0, None, closed=True, boxes=0)

    def verdict(factor: float, safe: float) -> tuple[Stability, Point | None, int]:
        grown = problem.box.grown(factor, floor)
        inside = replace(problem, box=grown)
        hull = replace(problem, box=grown.joined(problem.box.grown(safe, floor)))
        if equation:
            return _equation_holds(inside, hull, until, path, budget)
        found = verdict_from(inside, hull, until, "force_reference", budget)
        if found.status is Stability.UNDECIDED and safe < factor == 1.0:  # the box itself
            found = verdict_from(inside, inside, until, "force_reference", budget)
        return found.status, found.witness, found.boxes

    return bracket(verdict, 1.0, tolerance, _LEAST, LARGEST)


def _equation_holds(
    inside: BoxedLoop, hull: BoxedLoop, equation: str, path: str, budget: int
) -> tuple[Stability, Point | None, int]:
    """Return whether the ratio is below 1 in a hull of grown boxes, or above in the one inside."""
    loop = "velocity" if equation == "equation_17" else "position"
    form, curve = form_of(inside, loop, path, equation), curve_of(1.0)
    attained, place, _ = attain(inside, form, curve, 1.0)
    if attained >= 1:
        return Stability.UNSTABLE, point_of(inside, place), 0
    edges = edges_of(hull, (0.0, 0.0))
    edges[1, 0] = tail_start(form, edges[1, RATIO], 1.0)
    proof = Proof(form, curve, edges)
    proved = proof.run(1.0, budget) == PROVED
    return Stability.STABLE if proved else Stability.UNDECIDED, None, proof.boxes


def _nominal_stable(problem: BoxedLoop, path: str, floor: float) -> bool:
    """Return whether the nominal plant, from which the box grows, is surely stable."""
    mass, delay = problem.box.nominal
    stable, _ = stable_plants(
        problem, plants_of([mass, max(delay, floor), 0.0, 0.0], problem.share_a), path
    )
    return bool(stable[0])
