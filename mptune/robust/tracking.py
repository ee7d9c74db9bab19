"""The tracking index of a family's linear loops: peak position error over peak velocity (§7.2)."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from mptune.loops.family import FamilyLoops, time_constants_at
from mptune.params.pack import pack_estimator, pack_feedforward
from mptune.params.packed import Plants
from mptune.sim.moves import distinct_moves
from mptune.sim.response import tracking
from mptune.sim.running import tracking_peaks

if TYPE_CHECKING:
    from mptune.arrays import FloatArray, IntArray
    from mptune.params.controller import Feedforward
    from mptune.params.packed import LoopGains
    from mptune.params.study import ResolvedStudy
    from mptune.robust.model import LinearModel
    from mptune.sim.moves import Moves

BINS = 16  # of time: the error's peak in each is a smooth function of the gains
_SAMPLES_PER_MOVE = 20 * BINS
_FRICTIONLESS = {"viscous_friction": 0.0, "coulomb_friction": 0.0}


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
    of the study's model; the sampled one is the loop as it runs, feed-forward and state estimator
    included, but for friction's, of which linear loops have none. Which of them is the objective's
    ``tracking_loop``.

    Parameters
    ----------
    model
        The study's linear model.
    gains, feedforward
        What controls the machine.
    rows
        Of ``tracked_plants``; all of them where None.
    running_away
        Of the sampled loop, see ``mptune.sim.running.tracking_peaks``.

    Returns
    -------
    FloatArray
        ``(n, M, BINS)``; the index is the largest of it.
    """
    moves, plants = _moves(model.study.study.manoeuvre), tracked_plants(model)
    plants = plants if rows is None else plants.picked(rows)
    if model.study.study.objective.tracking_loop == "sampled":
        loops = model.as_it_runs(gains, plants)
        masses = model.study.uncertainty.mass
        ahead = pack_feedforward(
            feedforward.model_copy(update=_FRICTIONLESS), model.filters.sample_time, masses
        )
        by = pack_estimator(model.study)
        peaks = [
            tracking_peaks(loops, model.period, move, ahead, BINS, by, running_away=running_away)
            for move in moves
        ]
    else:
        peaks = [_continuous(model, plants, gains, move) for move in moves]
    return np.asarray(np.stack(peaks, axis=1))


_moves = lru_cache(maxsize=16)(distinct_moves)


def tracked_plants(model: LinearModel) -> Plants:
    """Return the plants on which tracking is judged, with the delays of its loop.

    They are the family's; or the machines of [verification], each with the middle of its valves'
    delay and the longest computation, and the time constants of pressure that its oil has at the
    start position (Eq. 4 and Eq. 12).
    """
    objective = model.study.study.objective
    if objective.tracking_plants == "family":
        return model.explicit if objective.tracking_loop == "sampled" else model.plants
    return verification_plants(model.study)


def verification_plants(study: ResolvedStudy) -> Plants:
    """Return the machines of [verification] as plants: mass by delay by oil, ``(N,)`` each."""
    asked, machine = study.study.verification, study.study
    after = machine.valves.computation_delay[1] + machine.controller.sampling_period / 2
    delays = [sum(pair) / 2 + after for pair in asked.delay_ranges()]
    oils = np.array(asked.oil_bulk_moduli)
    mass, delay, oil = (
        axis.ravel() for axis in np.meshgrid(asked.masses, delays, oils, indexing="ij")
    )
    tau_a, tau_b = time_constants_at(study, oil, asked.start)
    return Plants(mass, delay, tau_a, tau_b, np.full(len(mass), machine.share_a))


def _continuous(model: LinearModel, plants: Plants, gains: LoopGains, move: Moves) -> FloatArray:
    time = np.linspace(0, move.duration, _SAMPLES_PER_MOVE + 1)
    wanted = move.sampled(_SAMPLES_PER_MOVE)
    loops = FamilyLoops(plants, gains, model.path)
    position, velocity = tracking(loops, time, move.pieces)
    error = np.abs(position - wanted)[:, 1:].reshape(len(plants.mass), BINS, -1).max(axis=2)
    return np.asarray(error / np.abs(velocity).max(axis=1)[:, None])
