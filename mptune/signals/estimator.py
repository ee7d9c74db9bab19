"""A state estimator in the place of the position filter and Eq. 23, and its responses.

The force is known from both chamber pressures, F = A_A p_A − A_B p_B, so that position and velocity
need no lag: they are predicted with a fixed mass m̂, and the error of the predicted position
corrects them and the load force d̂, at T_S,fast::

    a = (F_e − d̂)/m̂,  F_e = F + (m̂ − m_ff) a_ref where the reference is injected
    x̂ ← x̂ + T v̂ + T² a/2,  v̂ ← v̂ + T a
    e = y − x̂
    x̂ ← x̂ + l_1 e,  v̂ ← v̂ + l_2 e,  d̂ ← d̂ − m̂ l_3 e

y and both pressures have passed the median of three, and nothing else. With w = e^{−sT},
ŝ = (1 − w)/T, λ_i = l_i/T and Δ = ŝ³ + λ_1 w ŝ² + λ_2 w ŝ + λ_3 w (1 + w)/2, the responses are ::

    x̂/y = (λ_1 ŝ² + λ_2 w ŝ + λ_3 w (1 + w)/2)/Δ      v̂/y = ŝ (λ_2 ŝ + λ_3 w)/Δ
    m̂ x̂/F = (1 − l_1) ŝ (1 + w)/2/Δ                   m̂ v̂/F = ŝ (ŝ + λ_1 w − T λ_2/2)/Δ

which is the state space solved by hand. Reference injection adds what is known, outside any loop.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import Complex, ComplexArray, FloatArray, kernel
from mptune.signals.states import (
    LAST_VELOCITY_REFERENCE,
    LOAD_HEARD,
    POSITION_HEARD,
    VELOCITY_HEARD,
)

if TYPE_CHECKING:
    from mptune.params.packed import MeasurementPath, StateEstimator


class Heard(NamedTuple):
    """What the estimator makes of position and force, median included."""

    place_of_place: Complex  # -, x̂ over position
    speed_of_place: Complex  # 1/s, v̂ over position
    place_of_force: Complex  # m/N, x̂ over force
    speed_of_force: Complex  # m/(N s), v̂ over force


@kernel
def estimate(
    state: FloatArray,
    by: StateEstimator,
    sample_time: float,
    position: float,
    force: float,
    velocity_reference: float,
    mass: float,
) -> None:
    """Carry the estimator one T_S,fast on.

    Parameters
    ----------
    state
        ``(OUTER_STATES,)`` of ``mptune.signals.states``; carried on in place. It still holds
        v_ref of the tick before.
    by
        Mass and gains.
    sample_time
        T_S,fast [s].
    position, force
        Of this tick: the median of the position [m], and the force of the pressures' medians [N].
    velocity_reference
        v_ref of this tick [m/s], whose rise since the last is T·a_ref.
    mass
        m_ff, the mass that is fed forward [kg].
    """
    rise = (velocity_reference - state[LAST_VELOCITY_REFERENCE]) / sample_time  # a_ref
    known = force + by.injected * ((by.mass - mass) * rise)
    acceleration = (known - state[LOAD_HEARD]) / by.mass
    place = state[POSITION_HEARD] + sample_time * (
        state[VELOCITY_HEARD] + 0.5 * sample_time * acceleration
    )
    error = position - place
    state[POSITION_HEARD] = place + by.l_1 * error
    state[VELOCITY_HEARD] = state[VELOCITY_HEARD] + sample_time * acceleration + by.l_2 * error
    state[LOAD_HEARD] = state[LOAD_HEARD] - by.mass * by.l_3 * error


@kernel
def heard(s: Complex, path: MeasurementPath) -> Heard:
    """Return the estimator's responses at s, through z = e^{sT_S,fast}."""
    time = path.sample_time
    late = np.exp(-s * time)
    slope = 2 * np.exp(-0.5 * s * time) * np.sinh(0.5 * s * time) / time  # ŝ, no digits lost
    first, second, third = path.l_1 / time, path.l_2 / time, path.l_3 / time
    correction = first * slope * slope
    correction += second * late * slope + third * late * (1 + late) / 2
    below = late / (first * (late - 1) * slope * slope + slope**3 + correction)  # median over Δ
    return Heard(
        correction * below,
        slope * (second * slope + third * late) * below,
        (1 - path.l_1) * slope * (1 + late) / 2 * below / path.estimator_mass,
        slope * (slope + first * late - time * second / 2) * below / path.estimator_mass,
    )


@kernel
def heard_along(s: ComplexArray, path: MeasurementPath) -> ComplexArray:
    """Return ``(4, F)`` the estimator's responses at each s, in the order of ``Heard``."""
    found = np.empty((4, len(s)), np.complex128)
    for n in range(len(s)):
        found[:, n] = np.array(heard(s[n], path))
    return found
