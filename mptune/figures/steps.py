"""Which loop's steps are drawn: the continuous one, or with a state estimator the one that runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.params.pack import pack_estimator
from mptune.sim.response import farthest, load_step, position_step, velocity_step
from mptune.sim.running_steps import StepOf, running_steps

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.params.controller import Gains
    from mptune.robust.model import LinearModel

_CONTINUOUS = {
    StepOf.VELOCITY: velocity_step,
    StepOf.POSITION: position_step,
    StepOf.LOAD: load_step,
}


def family_and_nominal(
    model: LinearModel, gains: Gains, of: StepOf, horizon: float, count: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return times ``(T,)`` and the unit steps of family ``(N, T)`` and nominal plant ``(1, T)``.

    With a state estimator the loops are sampled as they run; where no hold fits into the delay, and
    without an estimator, they are continuous with the study's measurement path.

    Parameters
    ----------
    model, gains
        The linear model and what controls it.
    of
        What steps.
    horizon
        How long to follow it [s]; a continuous loop is followed no longer than it can be.
    count
        Number of times.
    """
    if model.estimated and model.runs:
        time = np.linspace(0, horizon, count)
        pair = model.as_it_runs(gains), model.nominal_loop(gains, model.filters)
        by = pack_estimator(model.study)
        family, nominal = (running_steps(one, model.period, time, of, by) for one in pair)
    else:
        pair = model.loops(gains), model.nominal_loop(gains)
        time = np.linspace(0, min(horizon, *map(farthest, pair)), count)
        family, nominal = (_CONTINUOUS[of](one, time) for one in pair)
    return time, family, nominal
