"""Encirclement counts against loops whose closed-loop poles are known in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from mptune.loops.broken import VELOCITY
from mptune.loops.family import FamilyLoops
from mptune.loops.stability import count_unstable_poles
from mptune.params.packed import NO_PATH, LoopGains, Plants


def integrator_with_dead_time(gain, mass, delay):
    """Return K e^{−sd}/(m s), one loop per entry."""
    mass, delay = np.atleast_1d(mass).astype(float), np.atleast_1d(delay).astype(float)
    zero = np.zeros(len(mass))
    gains = LoopGains(gain, 0.0, 0.0, 42.0, 0.55, 0.006)
    plants = Plants(mass, delay, zero, zero, zero + 0.57)
    return count_unstable_poles(FamilyLoops(plants, gains, NO_PATH, VELOCITY))


def test_an_integrator_with_dead_time_is_stable_below_m_pi_over_2d():
    limit = 24500 * np.pi / (2 * 0.011)
    print(f"K = m π/(2d) at 24500 kg, 11 ms: {limit / 1e3:.1f} kN s/m")
    assert round(limit / 1e3, 1) == 3498.6
    assert integrator_with_dead_time(0.999 * limit, 24500, 0.011).stable.all()
    above = integrator_with_dead_time(1.001 * limit, 24500, 0.011)
    assert above.decided.all()
    assert above.unstable.tolist() == [2]


@pytest.mark.parametrize("nearness", [1e-6, 1e-9])
def test_the_boundary_is_told_apart_to_many_digits(nearness):
    limit = 24500 * np.pi / (2 * 0.011)
    assert integrator_with_dead_time((1 - nearness) * limit, 24500, 0.011).stable.all()
    assert not integrator_with_dead_time((1 + nearness) * limit, 24500, 0.011).stable.any()


def test_a_loop_through_the_critical_point_is_undecided_and_not_stable():
    count = integrator_with_dead_time(24500 * np.pi / (2 * 0.011), 24500, 0.011)
    assert not count.decided.any()
    assert not count.stable.any()


def test_further_pairs_of_poles_cross_at_every_further_turn():
    # s + a e^{−s}: a pair crosses into the right half plane at a = π/2 + 2πk
    gain = np.array([1.0, 1.5, 1.6, 7.8, 7.9, 14.1, 14.2, 100.0])
    expected = 2 * np.ceil((gain - np.pi / 2) / (2 * np.pi)).clip(0).astype(int)
    count = integrator_with_dead_time(1e6, 1e6 / gain, np.ones(len(gain)))
    assert count.decided.all()
    assert count.unstable.tolist() == expected.tolist()


def test_more_dead_time_never_takes_poles_away_from_an_integrator():
    delay = np.linspace(0.0, 0.5, 60)
    count = integrator_with_dead_time(700e3, np.full(60, 24500.0), delay)
    assert count.decided.all()
    assert np.all(np.diff(count.unstable) >= 0)
    assert count.unstable[0] == 0
    assert count.unstable[-1] > 0


def test_without_a_proportional_term_the_position_loop_is_unstable():
    # m s³ + K s² + K K_I has no term in s: Hurwitz's condition fails at any gain
    mass = np.array([24500.0])
    zero = np.zeros(1)
    gains = LoopGains(700e3, 0.0, 22.0, 42.0, 0.55, 0.006)
    loops = FamilyLoops(Plants(mass, zero, zero, zero, zero + 0.57), gains, NO_PATH)
    count = count_unstable_poles(loops)
    roots = np.roots([24500, 700e3, 0, 700e3 * 22])
    assert count.decided.all()
    assert count.unstable.tolist() == [int(np.sum(roots.real > 0))] == [2]


@dataclass(frozen=True)
class UnstablePlant:
    """K e^{−sd}/(s − 1), one loop per delay."""

    gain: float
    delay: np.ndarray
    integrators: int = 0

    @property
    def leading(self):
        return np.zeros(len(self.delay))

    @property
    def radius(self):
        return np.ones(len(self.delay))

    @property
    def tail(self):
        return np.full(len(self.delay), 2 * self.gain + 1)  # |s − 1| ≥ |s| − 1

    def response(self, s, rows):
        return self.gain * np.exp(-s * self.delay[rows]) / (s - 1)

    def bound(self, omega, rows):
        return self.gain / np.abs(1j * omega - 1)

    def rate(self, omega, rows):
        return self.delay[rows] + 1.0


def test_an_unstable_plant_is_stabilised_by_enough_gain_only():
    for gain, unstable in ((0.5, 1), (0.999, 1), (1.001, 0), (2.0, 0)):
        count = count_unstable_poles(UnstablePlant(gain, np.zeros(1)), open_loop_poles=1)
        assert count.decided.all()
        assert count.unstable.tolist() == [unstable]


def test_an_unstable_plant_bears_dead_time_up_to_its_known_limit():
    limit = np.arccos(1 / 2) / np.sqrt(2**2 - 1)
    loops = UnstablePlant(2.0, limit * np.array([0.5, 0.9999, 1.0001, 1.5]))
    assert (
        count_unstable_poles(loops, open_loop_poles=1).stable.tolist() == [True] * 2 + [False] * 2
    )


def test_counts_and_verdicts_cannot_be_changed():
    count = integrator_with_dead_time(700e3, 24500, 0.011)
    with pytest.raises(ValueError, match="read-only"):
        count.unstable[0] = 0
