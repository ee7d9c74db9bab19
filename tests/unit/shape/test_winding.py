"""Closed-loop poles of rational loops with dead time against roots and known limits."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from mptune.shape.rational import RationalPlant
from mptune.shape.rational_loops import RationalLoops
from mptune.shape.winding import count_closed_poles


def count(plant, numerator, denominator=(1.0,)):
    return count_closed_poles(RationalLoops([plant], numerator, denominator))


real = st.floats(-5, 5)
pairs = st.tuples(st.floats(-1, 1), st.floats(0.1, 5))


@settings(max_examples=60)
@given(
    gain=st.floats(-50, 50),
    zeros=st.lists(real, max_size=2),
    poles=st.lists(real, min_size=1, max_size=3),
    pair=pairs,
    k_i=st.floats(-3, 3),
    integrators=st.integers(0, 2),
)
def test_count_is_that_of_the_roots(gain, zeros, poles, pair, k_i, integrators):
    assume(abs(gain) > 1e-3)
    light = complex(*pair)
    every = [*poles, light, light.conjugate(), *([0.0] * integrators)]
    plant = RationalPlant(zeros, every, gain)
    found = count(plant, [1.0, k_i], [1.0, 0.0])
    top = np.polymul(np.atleast_1d(np.poly(zeros)) * gain, [1.0, k_i] if k_i else [1.0])
    bottom = np.polymul(np.real(np.poly(every)), [1.0, 0.0] if k_i else [1.0])
    closed = np.roots(np.polyadd(bottom, top))
    assume(np.abs(closed.real).min() > 1e-3)
    assert found.decided[0]
    assert found.unstable[0] == np.sum(closed.real > 0)


@pytest.mark.parametrize("damping", [1e-3, 1e-6, 1e-9, 0.0, -1e-9])
def test_light_modes_are_counted_exactly(damping):
    """From k = 2ζ/sin d on the mode of 1/(s² + 2ζs + 1)·e^{−sd} grows."""
    pole = complex(-damping, 1.0)
    plant = RationalPlant([], [pole, pole.conjugate()], 1.0, delay=0.1)
    for share, unstable in ((0.9, damping <= 0), (1.1, True)):
        limit = max(20 * damping, 1e-9)
        found = count(plant, [share * limit])
        assert found.decided[0]
        assert found.unstable[0] == 2 * unstable


@pytest.mark.parametrize(("gain", "unstable"), [(0.99, 0), (1.01, 2), (2.99 * 1.6, 2), (5.01, 4)])
def test_dead_time_has_its_known_limits(gain, unstable):
    """k·e^{−s}/s loses a pair of poles at k = π/2, 5π/2, …"""
    plant = RationalPlant([], [0.0], 1.0, delay=1.0)
    found = count(plant, [gain * np.pi / 2])
    assert found.decided[0]
    assert found.unstable[0] == unstable


def test_hidden_unstable_pole_is_counted():
    """A zero of the controller that cancels a growing pole leaves it growing."""
    found = count(RationalPlant([], [1.0, -2.0], 5.0), [1.0, -1.0], [1.0, 4.0])
    assert found.unstable[0] == 1


def test_pole_on_the_axis_is_no_stable_loop():
    cancelled = count(RationalPlant([0.0], [-1.0, -2.0], 1.0), [1.0], [1.0, 0.0])
    assert not cancelled.stable[0]


@pytest.mark.parametrize(("gain", "unstable"), [(3.0, 0), (-0.4, 0), (-0.7, 1), (-2.0, 0)])
def test_loops_that_do_not_fall_off(gain, unstable):
    """k(s + 2)/(s + 1): the closed loop's pole is −(1 + 2k)/(1 + k)."""
    found = count(RationalPlant([-2.0], [-1.0], gain), [1.0])
    assert found.decided[0]
    assert found.unstable[0] == unstable


@pytest.mark.parametrize(("gain", "stable"), [(0.3, True), (-0.45, True), (1.01, False)])
def test_neutral_loops_need_a_gain_below_one(gain, stable):
    """k(s + 2)/(s + 1)·e^{−s}: from |k| = 1 on there are poles without end, which none counts."""
    found = count(RationalPlant([-2.0], [-1.0], gain, delay=1.0), [1.0])
    assert found.decided[0] == stable
    assert found.stable[0] == stable


def test_rows_are_counted_one_by_one():
    """Plants of different degrees in one count."""
    plants = [
        RationalPlant([], [-1.0], 1.0),
        RationalPlant([], [-1.0] * 3, 9.0),
        RationalPlant([], [2.0, -1.0], 1.0, 0.1),
    ]
    found = count_closed_poles(RationalLoops(plants, [1.0], [1.0]))
    assert found.unstable.tolist() == [0, 2, 1]


def test_no_gain_leaves_the_open_loop():
    found = count(RationalPlant([], [1.0, -2.0], 5.0), [0.0, 0.0], [1.0, 0.0])
    assert found.unstable[0] == 1
