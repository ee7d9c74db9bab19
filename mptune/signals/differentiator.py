"""The differentiating filter of Harrison and Stoten: velocity from filtered position (§5.2)."""

from __future__ import annotations

import numpy as np

from mptune.arrays import Complex, FloatArray, kernel

WEIGHTS = (5.0, 3.0, 1.0, -1.0, -3.0, -5.0)  # Eq. 23, of filtered positions, newest first
DIVISOR = 35.0  # Eq. 23, times T_S,fast
TAPS = np.array(WEIGHTS) / DIVISOR  # Eq. 23, times T_S,fast
TAPS.setflags(write=False)


@kernel
def differentiated(history: FloatArray, sample_time: float) -> float:
    """Return the velocity that Eq. 23 reads from filtered positions [m/s].

    Parameters
    ----------
    history
        ``(6,)`` filtered positions, newest first [m].
    sample_time
        T_S,fast [s].
    """
    velocity = 0.0
    for tap in range(len(WEIGHTS)):
        velocity += WEIGHTS[tap] * history[tap]
    return velocity / (DIVISOR * sample_time)  # Eq. 23


@kernel
def remember(history: FloatArray, position: float) -> None:
    """Put a filtered position first in its history ``(6,)``; the oldest is forgotten."""
    for tap in range(len(WEIGHTS) - 1, 0, -1):
        history[tap] = history[tap - 1]
    history[0] = position


@kernel
def differentiator_over_s(s: Complex, sample_time: float) -> Complex:
    """Return the response of Eq. 23 divided by that of a perfect differentiator, D(s)/s.

    The six taps are paired about their middle, so that low frequencies lose no digits. As
    (1 − e^{−sT})/s is an integral of e^{−su} over u, D(s)/s is an average of pure delays between
    0 and 5 T with weights that add up to 1: its modulus is at most 1 where Re s ≥ 0, and it is a
    delay of 2.5 T to first order.
    """
    half = 0.5 * s * sample_time
    outer, middle, inner = WEIGHTS[:3]
    pairs = outer * np.sinh(5 * half) + middle * np.sinh(3 * half) + inner * np.sinh(half)
    return np.exp(-5 * half) * pairs * 2 / (DIVISOR * sample_time * s)  # Eq. 23
