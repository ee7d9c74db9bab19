"""A family's linear loops as they run, in time: what a move and a step of the position come to."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, kernel
from mptune.loops.velocity import plant_at
from mptune.params.controller import Feedforward
from mptune.params.pack import pack_feedforward
from mptune.params.packed import NO_ESTIMATOR, StateEstimator
from mptune.sim.sampled import DIVERGED, run_linear

if TYPE_CHECKING:
    from mptune.loops.family import FamilyLoops
    from mptune.params.packed import (
        FeedforwardTuple,
        LoopGains,
        MeasurementPath,
        Plants,
    )
    from mptune.sim.moves import Moves

BAND = 0.02  # of a step: within it for good, the step has settled
_SLOWEST = 8.0  # times the slowest corner of Eq. 22, after which a step is judged
_SHORTEST, _LONGEST = 1.0, 20.0  # s


class StepFigures(NamedTuple):
    """A step of the position reference alone, of N plants, ``(N,)`` each."""

    overshoot: FloatArray  # of the step
    settling_time: FloatArray  # s, until it stays within ``BAND``; infinite where it does not
    late_deviation: FloatArray  # largest deviation from the time that was asked on, over ``BAND``


def tracking_peaks(
    loops: FamilyLoops,
    period: float,
    move: Moves,
    ahead: FeedforwardTuple,
    bins: int,
    estimator: StateEstimator = NO_ESTIMATOR,
    *,
    running_away: bool = False,
) -> FloatArray:
    """Return each plant's peak error in each window of time over its peak velocity [s].

    Of a loop that runs away both peaks are its own growth: it is infinite in every window.

    Parameters
    ----------
    loops
        The plants, the gains, and the measurement path as it runs.
    period
        T_S [s].
    move
        The reference.
    ahead
        Feed-forward.
    bins
        Number of windows.
    estimator
        The state estimator; the filters of the loops' path without one.
    running_away
        Whether loops that run away keep the quotient of their peaks, which tells a search the way
        back though it says nothing of tracking.

    Returns
    -------
    FloatArray
        ``(N, bins)``.
    """
    ticks = round(move.duration / loops.path.sample_time) // bins * bins
    packed = loops.plants, loops.gains, loops.path
    farthest = np.inf if running_away else DIVERGED * move.reach
    given = period, move.pieces, ahead
    return np.asarray(_peaks(*packed, *given, ticks, bins, estimator, farthest))


@kernel
def _peaks(
    plants: Plants,
    gains: LoopGains,
    path: MeasurementPath,
    period: float,
    pieces: FloatArray,
    ahead: FeedforwardTuple,
    ticks: int,
    bins: int,
    estimator: StateEstimator,
    farthest: float,
) -> FloatArray:
    found = np.zeros((len(plants.mass), bins))
    for n in range(len(plants.mass)):
        plant = plant_at(plants, n)
        traces = run_linear(plant, gains, path, period, pieces, ahead, ticks, estimator)
        fastest, per_bin, stays = 0.0, ticks // bins, True
        for tick in range(ticks):
            error, speed = abs(traces[0, tick] - traces[1, tick]), abs(traces[2, tick])
            place = tick // per_bin
            if not error <= found[n, place]:  # what is no number counts as the largest
                found[n, place] = error
            fastest = max(fastest, speed)
            stays = stays and abs(traces[1, tick]) <= farthest  # what is no number does not
        found[n] /= fastest
        if not stays and farthest < np.inf:
            found[n] = np.inf
    return found


def step_figures(loops: FamilyLoops, period: float, asked: float = 0.0) -> StepFigures:
    """Return what a step of the position reference alone comes to, no feed-forward with it.

    Settling is judged up to ``_SLOWEST`` times the slowest corner of Eq. 22; what has not settled
    by then has no settling time.

    Parameters
    ----------
    loops, period
        As of ``tracking_peaks``.
    asked
        The time [s] from which the late deviation counts.
    """
    gains, fast = loops.gains, loops.path.sample_time
    slowest = 1 / max(gains.k_p_pos, 1 / _LONGEST)
    if gains.k_i_pos > 0 and gains.k_p_pos > 0:
        slowest = max(slowest, gains.k_p_pos / gains.k_i_pos)
    end = max(min(max(_SLOWEST * slowest, _SHORTEST), _LONGEST), 2 * asked)
    none = pack_feedforward(Feedforward(), fast)
    first = int(np.ceil(asked / fast))
    path = loops.path
    by = StateEstimator(path.estimator_mass, path.l_1, path.l_2, path.l_3, 0.0)  # a_ref = 0
    packed = loops.plants, gains, path
    return StepFigures(*_steps(*packed, period, none, round(end / fast), first, by).T)


@kernel
def _steps(
    plants: Plants,
    gains: LoopGains,
    path: MeasurementPath,
    period: float,
    ahead: FeedforwardTuple,
    ticks: int,
    first: int,
    estimator: StateEstimator,
) -> FloatArray:
    step = np.zeros((1, 7))
    step[0, 1] = 1.0
    found = np.zeros((len(plants.mass), 3))
    for n in range(len(plants.mass)):
        plant = plant_at(plants, n)
        traces = run_linear(plant, gains, path, period, step, ahead, ticks, estimator)
        settled = 0
        for tick in range(ticks):
            beyond = traces[1, tick] - 1
            found[n, 0] = max(found[n, 0], beyond)
            if not abs(beyond) <= BAND:
                settled = tick + 1
            if tick >= first:
                found[n, 2] = max(found[n, 2], abs(beyond) / BAND)
        found[n, 1] = settled * path.sample_time if settled < ticks else np.inf
    return found
