"""The outer loops of the literature as gains of Eq. 18 and Eq. 22 (refs. 5 and 6).

With ω = 1/τ and ξ = 1, Eq. 22's numerator cancels its denominator: what is left is PI.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mptune.params.controller import Gains

if TYPE_CHECKING:
    from mptune.params.systems import CascadeLoop, PidLoop

_CANCELLED = 6e-3  # s, any τ: it cancels


def pi_gains(k_p_vel: float, k_p: float, k_i: float, tau: float = _CANCELLED) -> Gains:
    """Return a velocity gain [N s/m] with PI position control [1/s], [1/s²]."""
    return Gains.model_validate(
        {
            "k_p_vel": k_p_vel,
            "k_p_pos": k_p,
            "k_i_pos": k_i,
            "omega": 1 / tau,
            "xi": 1.0,
            "tau": tau,
        },
        context={"si": True},
    )


def pid_gains(loop: PidLoop) -> Gains:
    """Return PID with a filtered derivative, K_P (1 + T_D s/(τs + 1)) + K_I/s.

    ω² = 1/(τ(τ + T_D)) and 2ξ/ω = 2τ + T_D.
    """
    tau, rise = loop.filter_time, loop.derivative_time
    omega = 1 / math.sqrt(tau * (tau + rise))
    found = pi_gains(loop.k_p_vel, loop.k_p, loop.k_i, tau)
    return found.model_copy(update={"omega": omega, "xi": 0.5 * omega * (2 * tau + rise)})


def cascade_gains(loop: CascadeLoop) -> Gains:
    """Return P position control around PI velocity control.

    The integral of the velocity's error is the position's error: K_P,pos = K_x + K_I/K_P and
    K_I,pos = K_x K_I/K_P.
    """
    ratio = loop.k_i / loop.k_p
    return pi_gains(loop.k_p, loop.k_x + ratio, loop.k_x * ratio)
