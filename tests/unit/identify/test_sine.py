"""Whole periods and the least-squares fit of a sine."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mptune.identify.sine import fit_sine, whole_periods

TICK = 0.5e-3


@given(omega=st.floats(0.2, 300), period=st.sampled_from([0.004, 0.01, 0.012]))
def test_records_hold_whole_periods_and_sample_no_phase_twice(omega, period):
    exact, length = whole_periods(omega, period)
    turns = exact * length * period / (2 * math.pi)
    assert turns == pytest.approx(round(turns), abs=1e-9)
    assert math.gcd(round(turns), length) == 1
    assert abs(omega / exact - 1) <= 0.5 / length + 1e-9
    assert length * period > 1.9


@given(
    omega=st.floats(1, 200),
    size=st.floats(0.1, 3),
    lag=st.floats(-3.1, 3.1),
    offset=st.floats(-1e4, 1e4),
)
def test_gain_and_phase_come_back(omega, size, lag, offset):
    exact, length = whole_periods(omega, 0.01)
    time = TICK * np.arange(20 * length)
    u = 1e4 * np.sin(exact * time + 0.3)
    y = size * 1e4 * np.sin(exact * time + 0.3 + lag) + offset
    response, quality = fit_sine(u, y[None], TICK, exact)
    assert response[0] == pytest.approx(size * np.exp(1j * lag), rel=1e-8)
    assert quality[0] == pytest.approx(1, abs=1e-8)


@pytest.mark.parametrize("noise", [0.1, 0.5, 1.0, 2.0])
def test_quality_tells_the_residual(noise):
    """Noise of a given rms over the sine's rms; beyond 1 the quality is negative."""
    exact, length = whole_periods(10.0, 0.01)
    time = TICK * np.arange(20 * length)
    u = np.sin(exact * time)
    random = np.random.default_rng(1)
    y = u + noise * math.sqrt(0.5) * random.standard_normal(len(time))
    _, quality = fit_sine(u, y[None], TICK, exact)
    assert quality[0] == pytest.approx(1 - noise**2, rel=0.1, abs=0.05)
    assert (quality[0] < 0) == (noise > 1) or noise == 1.0


def test_an_output_without_the_sine_has_no_quality():
    exact, length = whole_periods(10.0, 0.01)
    time = TICK * np.arange(20 * length)
    response, quality = fit_sine(np.sin(exact * time), np.zeros((1, len(time))), TICK, exact)
    assert response[0] == 0
    assert quality[0] == -math.inf


def test_each_output_is_fitted_on_its_own():
    exact, length = whole_periods(3.0, 0.01)
    time = TICK * np.arange(20 * length)
    u = np.sin(exact * time)
    response, _ = fit_sine(u, np.stack([u, 2 * u, -u]), TICK, exact)
    np.testing.assert_allclose(response, [1, 2, -1], rtol=1e-9)
