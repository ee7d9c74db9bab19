"""Tustin's approximation of the position controller at T_S, as the target runs it (§5.3)."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from mptune.arrays import Complex, kernel

if TYPE_CHECKING:
    from mptune.params.packed import LoopGains


class DiscreteController(NamedTuple):
    """Eq. 22 under Tustin: a second-order section in parallel with a trapezoidal integrator.

    With e the position error, v the output and w_1, w_2, i the states::

        v = b_0 e + w_1 + i',   i' = i + c (e + e_last)
        w_1' = b_1 e − a_1 y + w_2,   w_2' = b_2 e − a_2 y,   y = b_0 e + w_1
    """

    b0: float
    b1: float
    b2: float
    a1: float
    a2: float
    integral: float  # c = K_I,pos T_S/2


@kernel
def discretise(gains: LoopGains, sampling_period: float) -> DiscreteController:
    """Return Eq. 22 with s replaced by (2/T_S)(z − 1)/(z + 1).

    Tustin bends the frequency axis: a corner ω appears at (2/T_S) atan(ω T_S/2). A lag τ below
    T_S/2 gives a pole that rings with alternating sign.
    """
    c = 2 / sampling_period
    ratio = c / gains.omega
    lag = gains.tau * c
    scale = gains.k_p_pos / (lag + 1) ** 2
    return DiscreteController(
        scale * (ratio * ratio + 2 * gains.xi * ratio + 1),
        scale * 2 * (1 - ratio * ratio),
        scale * (ratio * ratio - 2 * gains.xi * ratio + 1),
        2 * (1 - lag * lag) / (lag + 1) ** 2,
        (1 - lag) ** 2 / (lag + 1) ** 2,
        gains.k_i_pos * sampling_period / 2,
    )


@kernel
def discrete_response(law: DiscreteController, w: Complex) -> Complex:
    """Return the response of the discretised Eq. 22 at w = e^{−sT_S} [1/s]."""
    shaped = (law.b0 + w * (law.b1 + w * law.b2)) / (1 + w * (law.a1 + w * law.a2))
    return shaped + law.integral * (1 + w) / (1 - w)
