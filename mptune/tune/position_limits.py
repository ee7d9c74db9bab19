"""Bounds of Eq. 22's ω and ξ, said of the parameters x = (K_P, 2ξK_P/ω, K_P/ω², K_I)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.shape.cones import Concave, Cone
from mptune.shape.problem import Linear

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.shape.problem import Requirement

_LEAST = 1e-12  # of x_0 and x_2 in ratios of theirs


def frequency_limits(low: float, high: float) -> tuple[Requirement, ...]:
    """Return low ≤ ω ≤ high [rad/s]: x_0 between low² x_2 and high² x_2."""
    return (
        Linear("omega ≥", np.array([-1 / low**2, 0.0, 1.0, 0.0]), 0.0),
        Linear("omega ≤", np.array([1 / high**2, 0.0, -1.0, 0.0]), 0.0),
    )


def damping_limits(low: float, high: float, omega: float) -> tuple[Requirement, ...]:
    """Return low ≤ ξ ≤ high; ω [rad/s] is a typical value that only sets a scale.

    As ξ² = x_1²/(4 x_0 x_2), the upper bound is a cone: x_1²/ξ² ≤ (x_0/ω + ω x_2)² −
    (x_0/ω − ω x_2)². The lower one asks that 2ξ √(x_0 x_2) − x_1, a concave function, be at most 0.
    """
    left = np.array([1 / omega, 1j / high, -omega, 0.0])
    right = np.array([1 / omega, 0.0, omega, 0.0])

    def value(x: FloatArray) -> float:
        return float(2 * low * np.sqrt(max(x[0], 0.0) * max(x[2], 0.0)) - x[1])

    def gradient(x: FloatArray) -> FloatArray:
        ratio = np.sqrt(max(x[0], _LEAST) / max(x[2], _LEAST))
        return np.array([low / ratio, -1.0, low * ratio, 0.0])

    def size(x: FloatArray) -> float:
        return float(max(abs(x[1]), 2 * low * np.sqrt(abs(x[0] * x[2]))))

    return (Concave("xi ≥", value, gradient, size), Cone("xi ≤", left, right))
