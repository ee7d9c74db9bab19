"""The outer loops as they run at T_S: Eq. 22 under Tustin inside Eq. 18, with feed-forward.

::

    F_ref = K_P,vel (v_ref + G_P (x_ref − x_f) − v_f)
            + m_ff a_ref(t + t_p) + b v_ref + F_C v_ref/√(v_ref² + v_s²)

x_f is the filtered position and v_f its Eq. 23 derivative, or both a state estimator's; x_ref and
v_ref may pass a lag of their own at T_S,fast. Where the reference's future is not known, a_ref is
fed t_p ahead as a_ref + t_p j_ref, which has the same mean. Friction's sign is smoothed by a root,
which every target has bit for bit, where a hyperbolic tangent is each library's own. The integrator
stands still inside the dead zone, and where the force reference is at a limit that it would go
further beyond. Nonlinear machine and linear run share these kernels; the exported controller says
the same in C, bit for bit.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, kernel
from mptune.signals.adaptive_mass import fed_mass
from mptune.signals.states import (
    FORCE,
    INTEGRAL,
    LAG_1,
    LAG_2,
    LAST_ERROR,
    REFERENCE,
    VELOCITY_REFERENCE,
)
from mptune.signals.trajectory import jerk, reference
from mptune.signals.tustin import DiscreteController, discretise

if TYPE_CHECKING:
    from mptune.params.packed import FeedforwardTuple, LoopGains

NO_LIMITS = (-np.inf, np.inf)


class OuterLaw(NamedTuple):
    """All constants of the outer loops."""

    k_p_vel: float  # N s/m
    position: DiscreteController  # Eq. 22
    ahead: FeedforwardTuple
    dead_zone: float  # m, of the integrator
    least: float  # N, of F_ref
    largest: float


@kernel
def outer_law(
    gains: LoopGains,
    ahead: FeedforwardTuple,
    sampling_period: float,
    dead_zone: float,
    limits: tuple[float, float],
) -> OuterLaw:
    """Return the constants of the outer loops.

    Parameters
    ----------
    gains, ahead
        The gains of Eq. 18 and Eq. 22, and the feed-forward.
    sampling_period
        T_S [s].
    dead_zone
        Position error below which the integrator stands still [m]; 0 for none.
    limits
        Least and largest force reference [N]; ``NO_LIMITS`` for none.
    """
    law = discretise(gains, sampling_period)
    return OuterLaw(gains.k_p_vel, law, ahead, dead_zone, limits[0], limits[1])


@kernel
def acceleration_ahead(time: float, pieces: FloatArray, ahead: FeedforwardTuple) -> float:
    """Return the acceleration that is fed forward [m/s²]: a_ref(t + t_p), or from a_ref and j_ref.

    ``time`` [s] and ``pieces`` ``(P, 7)`` as of ``mptune.signals.trajectory.reference``.
    """
    if ahead.jerk > 0:
        now: float = reference(time, pieces)[2]
        return now + ahead.preview * jerk(time, pieces)
    later: float = reference(time + ahead.preview, pieces)[2]
    return later


@kernel
def lag_references(state: FloatArray, law: OuterLaw, position: float, velocity: float) -> None:
    """Pass x_ref [m] and v_ref [m/s] through their lags, once per T_S,fast."""
    ahead = law.ahead
    state[REFERENCE] += (1 - ahead.reference_pole) * (position - state[REFERENCE])
    state[VELOCITY_REFERENCE] += (1 - ahead.velocity_reference_pole) * (
        velocity - state[VELOCITY_REFERENCE]
    )


@kernel
def friction_ahead(velocity: float, ahead: FeedforwardTuple) -> float:
    """Return the friction that is fed forward at a velocity reference [m/s], in N."""
    turn = ahead.friction_velocity
    sign = velocity / math.sqrt(velocity * velocity + turn * turn)
    return ahead.viscous_friction * velocity + ahead.coulomb_friction * sign


@kernel
def force_reference(
    state: FloatArray, law: OuterLaw, position: float, velocity: float, acceleration: float
) -> float:
    """Return F_ref [N], once per T_S.

    Parameters
    ----------
    state
        ``(OUTER_STATES,)`` of ``mptune.signals.states``; carried on in place.
    law
        The loops' constants.
    position, velocity
        As measured: filtered, and by Eq. 23, or as estimated [m], [m/s].
    acceleration
        What is fed forward of a_ref, see ``acceleration_ahead`` [m/s²].
    """
    tustin = law.position
    error = state[REFERENCE] - position
    shaped = tustin.b0 * error + state[LAG_1]  # Eq. 22, second-order section
    state[LAG_1] = tustin.b1 * error - tustin.a1 * shaped + state[LAG_2]
    state[LAG_2] = tustin.b2 * error - tustin.a2 * shaped
    gained = tustin.integral * (error + state[LAST_ERROR])  # Eq. 22, integral term
    if abs(error) < law.dead_zone:
        gained = 0.0
    state[LAST_ERROR] = error
    wanted = state[VELOCITY_REFERENCE] + shaped + state[INTEGRAL] - velocity
    force = law.k_p_vel * (wanted + gained) + fed_mass(state, law.ahead) * acceleration  # Eq. 18
    force += friction_ahead(state[VELOCITY_REFERENCE], law.ahead)
    winds_up = (force > law.largest and gained > 0) or (force < law.least and gained < 0)
    if not winds_up:
        state[INTEGRAL] += gained
    limited: float = min(max(force, law.least), law.largest)
    state[FORCE] = limited
    return limited
