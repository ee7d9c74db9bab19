"""Steps of a family's linear loops as they run: sampled, filters or state estimator in the path.

A state estimator hears the force at T_S,fast, and no continuous loop is what runs with one; its
steps are therefore these. The load's step begins with a decision. Between ticks responses are drawn
as straight lines: the largest value of a tick may be missed by less than its own change.
"""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from mptune.loops.velocity import plant_at
from mptune.params.controller import Feedforward
from mptune.params.pack import pack_feedforward
from mptune.params.packed import NO_ESTIMATOR, LoopGains
from mptune.sim.sampled import run_linear

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.loops.family import FamilyLoops
    from mptune.params.packed import StateEstimator

_POSITION_ROW, _VELOCITY_ROW = 1, 2  # of a linear run


class StepOf(IntEnum):
    """What steps by one at time 0, and what is followed."""

    VELOCITY = 0  # v_ref alone with the position loop open: the velocity
    POSITION = 1  # x_ref alone: the position
    LOAD = 2  # the load force, in N: the position [m]


def running_steps(
    loops: FamilyLoops,
    period: float,
    time: FloatArray,
    of: StepOf,
    estimator: StateEstimator = NO_ESTIMATOR,
) -> FloatArray:
    """Return the response to a unit step at each time, ``(N, T)``.

    Parameters
    ----------
    loops
        The plants with delays that hold T_S/2, the gains, and the measurement path as it runs.
    period
        T_S [s].
    time
        ``(T,)``, rises from 0 [s].
    of
        What steps.
    estimator
        The state estimator; its reference injection needs a reference without steps and is off.
    """
    gains, fast = loops.gains, loops.path.sample_time
    pieces, load, row = np.zeros((1, 7)), 0.0, _POSITION_ROW
    if of is StepOf.VELOCITY:
        gains, row = LoopGains(gains.k_p_vel, 0.0, 0.0, 1.0, 0.0, 1.0), _VELOCITY_ROW
        pieces[0, 2] = 1.0
    elif of is StepOf.POSITION:
        pieces[0, 1] = 1.0
    else:
        load = 1.0
    none, by = pack_feedforward(Feedforward(), fast), estimator._replace(injected=0.0)
    ticks = int(np.ceil(time[-1] / fast)) + 1
    found = np.empty((loops.plants.number, len(time)))
    for n in range(len(found)):
        plant = plant_at(loops.plants, n)
        traces = run_linear(plant, gains, loops.path, period, pieces, none, ticks, by, load)
        found[n] = np.interp(time, fast * np.arange(ticks), traces[row])
    return found
