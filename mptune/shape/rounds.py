"""Shaping in rounds: wider where the loop still acts, closer where a certificate found a peak."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from mptune.shape.grids import beyond
from mptune.shape.procedure import ShapeStatus
from mptune.shape.rational import landmarks
from mptune.shape.shaping import Shaped, shape_loop

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.shape.problem import Problem
    from mptune.shape.proofs import PeakVerdict, Proofs

_WIDENINGS = 4  # by a decade each
_ROUNDS = 8  # of shaping, with what the certificate found between the frequencies looked at


def shape_with_proof(
    problem: Problem, start: FloatArray | None, proofs: Proofs, ratio: float | None
) -> tuple[Problem, Shaped, tuple[PeakVerdict, ...]]:
    """Shape the loop, certify it, and shape it again with the peaks that were missed.

    Parameters
    ----------
    problem
        Loops, requirements, objective.
    start
        Parameters to start from ``(K,)``; found where None or not stabilising.
    proofs
        Stability and verdicts of the problem's loops.
    ratio
        The largest left/right ratio of the family, None where none is asked for.

    Returns
    -------
    tuple
        The problem on the last round's frequencies, the outcome, and a verdict on every peak. What
        is not proved within the rounds is called so, however good it looks on the grid.
    """
    replaced = False
    for _ in range(_ROUNDS):
        problem, shaped = _shaped_to_the_ends(problem, start)
        replaced |= shaped.start_replaced
        shaped = replace(shaped, start_replaced=replaced)
        if not shaped.stable:
            return problem, _unproven(shaped), ()
        verdicts = proofs.verdicts(shaped.parameters, problem.peaks, shaped.uses, ratio)
        if shaped.status is ShapeStatus.INFEASIBLE or all(one.kept for one in verdicts):
            return problem, shaped, verdicts
        missed = [1j * one.frequency for one in verdicts if one.attained > one.allowed]
        if not missed:
            break
        problem, start = _refined(problem, landmarks(missed)), shaped.parameters
    return problem, _unproven(shaped), verdicts


def _unproven(shaped: Shaped) -> Shaped:
    """Return the outcome as not proven, where it is not infeasible anyway."""
    if shaped.status is ShapeStatus.INFEASIBLE:
        return shaped
    return replace(shaped, status=ShapeStatus.UNPROVEN)


def _shaped_to_the_ends(problem: Problem, start: FloatArray | None) -> tuple[Problem, Shaped]:
    """Shape the loop; where it still acts at an end of the grid and more is known, widen it."""
    shaped = shape_loop(problem, start)
    replaced = shaped.start_replaced
    for _ in range(_WIDENINGS):
        added = [
            beyond(one, one.gain(shaped.parameters @ problem.structure.response(one.omega)))
            for one in problem.loops.values()
            if one.between is not None
        ]
        new = np.unique(np.concatenate([np.zeros(0), *added]))
        if not shaped.stable or not len(new):
            break
        problem = _refined(problem, new)
        shaped = shape_loop(problem, shaped.parameters)
    return problem, replace(shaped, start_replaced=replaced)


def _refined(problem: Problem, added: FloatArray) -> Problem:
    """Return the problem with frequencies added where plants are known at any."""
    loops = {
        name: one.refined(np.setdiff1d(added, one.omega)) for name, one in problem.loops.items()
    }
    return replace(problem, loops=loops)
