"""The mass that is fed forward, learnt on line from the force and the reference's own motion.

Recursive least squares of the chamber force on what the reference asks of it, at T_S,fast::

    F ≈ m a + b v + F_C v/√(v² + v_s²) + F_load,   a, v of the reference a few milliseconds ago

with forgetting. The factors stand still while the reference rests, since nothing can be learnt
then, and so does the forgetting once too little is known of the mass. Only the mass is used, held
within the family's: a wrong one leaves (m − m_ff) a_ref to the feedback and harms no margin.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import FloatArray, kernel
from mptune.signals.states import (
    COVARIANCE,
    FACTORS,
    LAGGED_ACCELERATION,
    LAGGED_VELOCITY,
    LAST_VELOCITY_REFERENCE,
    MASS,
    REGRESSORS,
)

if TYPE_CHECKING:
    from mptune.params.packed import FeedforwardTuple

FORGETTING = 0.9999  # per T_S,fast: half is forgotten in 3.5 s of motion
ACCELERATION_UNIT = 0.1  # m/s², of the first regressor: single precision holds all of them
VELOCITY_UNIT = 0.1  # m/s, of the second
LEAST_VELOCITY = 2e-3  # m/s: below it the reference counts as at rest
MOST_ACCELERATION = 2.0  # m/s²: beyond it the reference jumps, and no machine follows
# Variances of the factors at the start, over that of the force that nothing explains, about
# 500 N: 10 t and 5 kN s/m, 750 N and 1 kN.
FIRST_COVARIANCE = (4.0, 1.0, 2.25, 4.0)


@kernel
def fed_mass(state: FloatArray, ahead: FeedforwardTuple) -> float:
    """Return the mass that is fed forward [kg]: learnt, or fixed."""
    mass: float = state[MASS]
    return mass if ahead.adaptive > 0 else ahead.acceleration_mass


@kernel
def start_learning(state: FloatArray, ahead: FeedforwardTuple, load: float) -> None:
    """Set the mass to the feed-forward's, and the factors to it and to a load force [N]."""
    state[MASS] = min(max(ahead.acceleration_mass, ahead.mass_least), ahead.mass_largest)
    state[FACTORS] = state[MASS] * ACCELERATION_UNIT
    state[FACTORS + 1] = ahead.viscous_friction * VELOCITY_UNIT
    state[FACTORS + 2] = ahead.coulomb_friction
    state[FACTORS + 3] = load
    for i in range(REGRESSORS * REGRESSORS):
        state[COVARIANCE + i] = 0.0
    for i in range(REGRESSORS):
        state[COVARIANCE + (REGRESSORS + 1) * i] = FIRST_COVARIANCE[i]


@kernel
def learn_mass(
    state: FloatArray, ahead: FeedforwardTuple, force: float, velocity_reference: float
) -> None:
    """Carry the regression one T_S,fast on.

    Parameters
    ----------
    state
        ``(OUTER_STATES,)`` of ``mptune.signals.states``; carried on in place. It still holds
        v_ref of the tick before.
    ahead
        The feed-forward.
    force
        Of the pressures' medians [N].
    velocity_reference
        v_ref of this tick [m/s].
    """
    rise = (velocity_reference - state[LAST_VELOCITY_REFERENCE]) / ahead.sample_time
    fresh = 1 - ahead.regressor_pole
    state[LAGGED_VELOCITY] += fresh * (velocity_reference - state[LAGGED_VELOCITY])
    state[LAGGED_ACCELERATION] += fresh * (rise - state[LAGGED_ACCELERATION])
    jumps = abs(state[LAGGED_ACCELERATION]) > MOST_ACCELERATION
    if abs(velocity_reference) <= LEAST_VELOCITY or jumps:
        return
    speed = state[LAGGED_VELOCITY]
    turn = ahead.friction_velocity
    sign = speed / math.sqrt(speed * speed + turn * turn)
    motion, quick = state[LAGGED_ACCELERATION] / ACCELERATION_UNIT, speed / VELOCITY_UNIT
    _correct(state, (motion, quick, sign, 1.0), force)
    state[MASS] = min(max(state[FACTORS] / ACCELERATION_UNIT, ahead.mass_least), ahead.mass_largest)


@kernel
def _correct(
    state: FloatArray, regressors: tuple[float, float, float, float], force: float
) -> None:
    """Correct factors and covariance by one sample of the force [N]."""
    spread = np.empty(REGRESSORS)  # P φ
    error = force
    forgetting = FORGETTING if state[COVARIANCE] < FIRST_COVARIANCE[0] else 1.0
    scale = forgetting
    for i in range(REGRESSORS):
        total = 0.0
        for j in range(REGRESSORS):
            total += state[COVARIANCE + REGRESSORS * i + j] * regressors[j]
        spread[i] = total
        error -= state[FACTORS + i] * regressors[i]
        scale += total * regressors[i]
    for i in range(REGRESSORS):
        gain = spread[i] / scale
        state[FACTORS + i] += gain * error
        for j in range(REGRESSORS):
            place = COVARIANCE + REGRESSORS * i + j
            state[place] = (state[place] - gain * spread[j]) / forgetting
