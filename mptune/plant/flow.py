"""Flow through the on/off valves (§2.1)."""

from __future__ import annotations

import math

from mptune.arrays import kernel


@kernel
def orifice(difference: float, transition: float) -> float:
    """Return the signed square root of a pressure difference [Pa^0.5], smooth at zero.

    Below ``transition`` [Pa] a cubic with the same value and slope at the border takes the place of
    the root, whose slope is infinite at zero (Ellman and Piché 1999).
    """
    size = abs(difference)
    if size >= transition:
        return math.copysign(math.sqrt(size), difference)  # Eq. 2
    return difference * (3 - size / transition) / (2 * math.sqrt(transition))


@kernel
def orifice_slope(difference: float, transition: float) -> float:
    """Return the derivative of ``orifice`` with respect to the difference [Pa^-0.5]."""
    size = abs(difference)
    if size >= transition:
        return 0.5 / math.sqrt(size)
    return (3 - 2 * size / transition) / (2 * math.sqrt(transition))
