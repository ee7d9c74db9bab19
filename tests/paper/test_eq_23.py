"""Eq. 23: velocity from six filtered positions."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.signals.differentiator import (
    TAPS,
    differentiated,
    differentiator_over_s,
    remember,
)


def test_the_taps_are_the_printed_ones():
    np.testing.assert_array_equal(TAPS * 35, [5, 3, 1, -1, -3, -5])


def test_a_ramp_gives_its_slope():
    time = 0.0005 * np.arange(6)[::-1]  # newest first
    assert TAPS @ (0.07 * time + 0.15) / 0.0005 == pytest.approx(0.07, rel=1e-12)


def test_a_parabola_gives_the_slope_of_two_and_a_half_samples_ago():
    age = 0.0005 * np.arange(6)
    assert TAPS @ (0.5 * 3.0 * age**2) / 0.0005 == pytest.approx(3.0 * -2.5 * 0.0005, rel=1e-12)


def test_it_is_a_delay_of_two_and_a_half_samples_at_low_frequency():
    found = differentiator_over_s(1j, 0.0005)
    assert found == pytest.approx(np.exp(-2.5j * 0.0005), rel=1e-5)


@pytest.mark.parametrize("frequency", [1e-6, 1e-3, 1.0])
def test_low_frequencies_lose_no_digits(frequency):
    # D(s)/s = e^{−2.5 sT} (1 − c (ωT)² + …): the modulus is 1 to (ωT)²
    found = differentiator_over_s(1j * frequency, 0.0005)
    assert abs(found) == pytest.approx(1, abs=5 * (frequency * 0.0005) ** 2 + 1e-15)


def test_positions_remembered_tick_by_tick_give_the_slope_of_their_ramp():
    history = np.zeros(6)
    for tick in range(9):
        remember(history, 0.15 + 0.07 * 0.0005 * tick)
    assert history[0] > history[5] > 0.15
    assert differentiated(history, 0.0005) == pytest.approx(0.07, rel=1e-9)
