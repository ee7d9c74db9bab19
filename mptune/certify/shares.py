"""The share ω/ω_k that an alias ω_k of a frequency ω has in what is held, and 1/(jω_k): balls."""

from __future__ import annotations

from mptune.arrays import kernel
from mptune.certify.balls import ROUND, Dual, constant, widened


@kernel
def share_of(omega: float, half: float, shift: float) -> Dual:
    """Return ω/(ω + shift), which is 1 where nothing is shifted."""
    if shift == 0:
        return constant(1.0)
    at = omega + shift
    nearest = abs(at) * (1 - 4 * ROUND) - half
    value, slope = omega / at, shift / (at * at)
    error = widened(6 * ROUND * (abs(value) + abs(omega * slope)))
    spread = widened(abs(shift) * half / (abs(at) * nearest) + error)
    bend = 2 * abs(shift) / (nearest * nearest * nearest)
    slope_spread = widened(bend * half + 6 * ROUND * abs(slope))
    return Dual(complex(value, 0.0), error, spread, complex(slope, 0.0), slope_spread)


@kernel
def over_alias(omega: float, half: float, shift: float) -> Dual:
    """Return 1/(j(ω + shift)), the shift so large that this is no zero."""
    at = omega + shift
    nearest = abs(at) * (1 - 4 * ROUND) - half
    value, slope = 1 / at, 1 / (at * at)
    error = widened(4 * ROUND * abs(value))
    spread = widened(half / (abs(at) * nearest) + error)
    slope_spread = widened(2 * half / (nearest * nearest * nearest) + 6 * ROUND * slope)
    return Dual(complex(0.0, -value), error, spread, complex(0.0, slope), slope_spread)
