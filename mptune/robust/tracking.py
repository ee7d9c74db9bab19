"""The tracking index of a family's linear loops: peak position error over peak velocity (§7.2)."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from mptune.loops.family import FamilyLoops
from mptune.params.pack import pack_feedforward
from mptune.sim.moves import distinct_moves
from mptune.sim.response import tracking
from mptune.sim.running import tracking_peaks

if TYPE_CHECKING:
    from mptune.arrays import FloatArray, IntArray
    from mptune.params.controller import Feedforward
    from mptune.params.packed import LoopGains, Plants
    from mptune.robust.model import LinearModel
    from mptune.sim.moves import Moves

BINS = 16  # of time: the error's peak in each is a smooth function of the gains
_SAMPLES_PER_MOVE = 20 * BINS


def family_tracking(
    model: LinearModel,
    gains: LoopGains,
    feedforward: Feedforward,
    rows: IntArray | None = None,
    *,
    running_away: bool = False,
) -> FloatArray:
    """Return each plant's, move's and time window's peak error over its peak velocity [s].

    The continuous loop has velocity feed-forward alone, exact dead time, and the measurement path
    of the study's model; the sampled one is the loop as it runs, feed-forward included. Which of
    them is the objective's ``tracking_loop``.

    Parameters
    ----------
    model
        The study's linear model.
    gains, feedforward
        What controls the machine.
    rows
        Plants of the family; the whole where None.
    running_away
        Of the sampled loop, see ``mptune.sim.running.tracking_peaks``.

    Returns
    -------
    FloatArray
        ``(n, M, BINS)``; the index is the largest of it.
    """
    moves = _moves(model.study.study.manoeuvre)
    every = np.arange(model.plants.number)
    picked = every if rows is None else rows
    if model.study.study.objective.tracking_loop == "sampled":
        loops = model.as_it_runs(gains)
        loops = replace(loops, plants=loops.plants.picked(picked))
        ahead = pack_feedforward(feedforward, model.filters.sample_time)
        peaks = [
            tracking_peaks(loops, model.period, move, ahead, BINS, running_away=running_away)
            for move in moves
        ]
    else:
        plants = model.plants.picked(picked)
        peaks = [_continuous(model, plants, gains, move) for move in moves]
    return np.asarray(np.stack(peaks, axis=1))


_moves = lru_cache(maxsize=16)(distinct_moves)


def _continuous(model: LinearModel, plants: Plants, gains: LoopGains, move: Moves) -> FloatArray:
    time = np.linspace(0, move.duration, _SAMPLES_PER_MOVE + 1)
    wanted = move.sampled(_SAMPLES_PER_MOVE)
    loops = FamilyLoops(plants, gains, model.path)
    position, velocity = tracking(loops, time, move.pieces)
    error = np.abs(position - wanted)[:, 1:].reshape(len(plants.mass), BINS, -1).max(axis=2)
    return np.asarray(error / np.abs(velocity).max(axis=1)[:, None])
