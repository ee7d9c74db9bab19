"""Frequency responses of the measured signals' conditioning: median and first-order filter (§5.2).

Both run at T_S,fast and are taken as they run, through z = e^{−sT}, not as continuous stand-ins.
"""

from __future__ import annotations

import numpy as np

from mptune.arrays import Complex, kernel


@kernel
def median_response(s: Complex, sample_time: float) -> Complex:
    """Return the response of the three-point median, taken as one sample of delay.

    A median passes a monotone signal exactly one sample late; at an extremum it clips the peak, so
    that one sample is pessimistic in phase there and optimistic in gain.
    """
    return np.exp(-s * sample_time)


@kernel
def filter_response(s: Complex, sample_time: float, pole: float) -> Complex:
    """Return the response of the filter y(k) = a y(k−1) + (1 − a) x(k) with pole a."""
    return (1 - pole) / (1 - pole * np.exp(-s * sample_time))


@kernel
def median_of_three(first: float, second: float, third: float) -> float:
    """Return the middle one of three values."""
    low, high = min(first, second), max(first, second)
    return max(low, min(high, third))


@kernel
def backlash(held: float, value: float, width: float) -> float:
    """Return the output of a backlash block: it follows only what leaves its width [same unit]."""
    half = 0.5 * width
    return min(max(held, value - half), value + half)
