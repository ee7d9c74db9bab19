"""The differentiating filter of Harrison and Stoten: velocity from filtered position (§5.2)."""

from __future__ import annotations

import numpy as np

from mptune.arrays import Complex, kernel

TAPS = np.array([5.0, 3.0, 1.0, -1.0, -3.0, -5.0]) / 35.0  # Eq. 23, times T_S,fast
TAPS.setflags(write=False)


@kernel
def differentiator_over_s(s: Complex, sample_time: float) -> Complex:
    """Return the response of Eq. 23 divided by that of a perfect differentiator, D(s)/s.

    The six taps are paired about their middle, so that low frequencies lose no digits. As
    (1 − e^{−sT})/s is an integral of e^{−su} over u, D(s)/s is an average of pure delays between
    0 and 5 T with weights that add up to 1: its modulus is at most 1 where Re s ≥ 0, and it is a
    delay of 2.5 T to first order.
    """
    half = 0.5 * s * sample_time
    pairs = 5 * np.sinh(5 * half) + 3 * np.sinh(3 * half) + np.sinh(half)
    return np.exp(-5 * half) * pairs * 2 / (35 * sample_time * s)  # Eq. 23
