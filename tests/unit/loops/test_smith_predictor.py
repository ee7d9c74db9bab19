"""The encirclement count on a loop of another kind: the inside of a Smith predictor.

The plant P_0 = 1/(s + 1) and the PI controller C_0 = 1.8 + 4/s (ω_0 = 2 rad/s, ζ = 0.7) make the
predictor's controller C = C_0/(1 + C_0 P_0 (1 − e^{−sτ})). Whether C itself is stable depends on
the dead time τ: its poles are those of 1 + L with L = C_0 P_0 (1 − e^{−sτ}).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from mptune.loops.stability import count_unstable_poles


@dataclass(frozen=True)
class SmithPredictor:
    """L = (1.8 s + 4)/(s + 1) · A(s), one loop per dead time.

    A = (1 − e^{−sτ})/s is the integral of e^{−su} over u from 0 to τ, a sum of pure delays: it
    cancels the integrator, its moduli add up to τ, and none moves faster than τ.
    """

    dead_time: np.ndarray
    integrators: int = 0

    @property
    def leading(self):
        return np.zeros(len(self.dead_time))

    @property
    def radius(self):
        return np.ones(len(self.dead_time))

    @property
    def tail(self):
        # Right of the imaginary axis |1.8 s + 4| ≤ 4 |s + 1| and |A| ≤ 2/|s|: |L| ≤ 8/|s|
        return np.full(len(self.dead_time), 16.0)

    def response(self, s, rows):
        dead_time = self.dead_time[rows]
        origin = s == 0
        elsewhere = np.where(origin, 1.0, s)
        average = np.where(origin, dead_time, -np.expm1(-elsewhere * dead_time) / elsewhere)
        return (1.8 * s + 4) / (s + 1) * average

    def bound(self, omega, rows):
        return np.abs((1.8j * omega + 4) / (1j * omega + 1)) * self.dead_time[rows]

    def rate(self, omega, rows):
        return self.dead_time[rows] + 1.0 + 1.8 / 4


def stable(*dead_times):
    count = count_unstable_poles(SmithPredictor(np.array(dead_times)))
    assert count.decided.all()
    return count.stable.tolist()


def known_limit():
    """Return the dead time at which e^{−jωτ} = (1 + C_0 P_0)/(C_0 P_0) at ω² = 3.4."""
    omega = np.sqrt(3.4)
    quotient = (4 - omega**2 + 2.8j * omega) / (4 + 1.8j * omega)
    assert abs(quotient) == pytest.approx(1, rel=1e-14)
    return (2 * np.pi - np.angle(quotient)) / omega


def test_the_loop_is_finite_at_the_origin():
    loops = SmithPredictor(np.array([0.5, 3.0]))
    found = loops.response(np.zeros(2, np.complex128), np.arange(2))
    np.testing.assert_allclose(found, [2.0, 12.0], rtol=1e-15)  # 4 τ


def test_the_predictor_s_controller_is_stable_with_short_dead_time_only():
    assert stable(0.1, 1.0, 2.0, 2.99) == [True] * 4
    assert stable(3.00, 3.5) == [False] * 2


def test_the_verdict_changes_where_it_is_known_to():
    low, high = 2.9, 3.1
    while high - low > 1e-6:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stable(middle)[0] else (low, middle)
    print(f"the predictor's controller turns unstable at a dead time of {low:.4f} s")
    assert low == pytest.approx(2.994, abs=0.0005)
    assert low == pytest.approx(known_limit(), abs=2e-6)
