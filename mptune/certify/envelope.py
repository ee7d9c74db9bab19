"""A figure over frequency: attained and guaranteed on each of a set of intervals."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import FloatArray, frozen
from mptune.certify.ascent import close, explored, terms_of
from mptune.certify.climb import SINGULAR
from mptune.certify.form import Curve, curve_of, form_of
from mptune.certify.problem import edges_of
from mptune.certify.proof import Proof

if TYPE_CHECKING:
    from mptune.certify.problem import BoxedLoop

TOLERANCE = 1e-2
BUDGET = 100_000  # boxes per interval
_LITTLE = 10_000  # boxes for each further one, once a bound had to be raised
_FREQUENCIES = 5  # at which corners are tried, per interval


@dataclass(frozen=True)
class Envelope:
    """A figure's worst case over the box, on intervals of frequency.

    Attributes
    ----------
    omega
        ``(F + 1,)`` ends of the intervals [rad/s].
    attained, bound
        ``(F,)`` the largest value found on each, and what no plant exceeds on it; a disk margin's
        are those of max |S − T|/2, its inverse.
    closed
        ``(F,)`` whether both lie within the tolerance.
    boxes
        Boxes that the proofs took.
    """

    omega: FloatArray
    attained: FloatArray
    bound: FloatArray
    closed: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]
    boxes: int


def envelope(
    problem: BoxedLoop,
    loop: str,
    path: str,
    figure: str,
    omega: FloatArray,
    *,
    tolerance: float = TOLERANCE,
    allowed: float | Curve = 1.0,
    budget: int = BUDGET,
) -> Envelope:
    """Return a figure's attained and guaranteed worst cases between neighbouring frequencies.

    Parameters
    ----------
    problem, loop, path, figure, allowed
        As of ``mptune.certify.bounds.bound``. Whether loops are stable is not asked: values on the
        imaginary axis are all that stands here.
    omega
        ``(F + 1,)`` rising frequencies [rad/s]; as sampled up to π/T_S.
    tolerance
        How far apart both may be, relative to the attained value.
    budget
        Boxes per interval; few of them once a bound had to be raised, as its neighbours will be.
    """
    problem = problem.along(path)
    form, curve = form_of(problem, loop, path, figure), curve_of(allowed)
    rows = []
    for low, high in pairwise(omega):
        edges = edges_of(problem, (float(low), float(high)))
        found, point = explored(form, curve, edges, _FREQUENCIES)
        terms = terms_of(form, edges, found, point, tolerance)
        proof = Proof(form, curve, edges, terms)
        value, proved = close(proof, found, point, tolerance, budget)
        rows.append((value, proved, proof.boxes))
        if value < SINGULAR and proved > (1 + 2 * tolerance) * value:  # it had to be raised
            budget = min(budget, _LITTLE)
    attained, bound, boxes = (np.array(column) for column in zip(*rows, strict=True))
    closed = bound <= (1 + tolerance) * attained * (1 + 1e-9)
    return Envelope(
        frozen(np.array(omega, np.float64)),
        frozen(attained),
        frozen(bound),
        frozen(closed),
        int(boxes.sum()),
    )
