"""What holds for every plant, gain and frequency."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mptune.loops.force_dynamics import force_dynamics, pressure_time_constant
from mptune.plant.bulk import effective_bulk_modulus
from mptune.signals.conditioning import filter_response, median_response
from mptune.signals.differentiator import TAPS, differentiator_over_s

lags = st.floats(0.0, 0.1)
shares = st.floats(0.01, 0.99)
right_half_plane = st.builds(complex, st.floats(0.0, 2e3), st.floats(-1e4, 1e4))
sample_times = st.floats(1e-4, 1e-3)
ALMOST_ONE = 1 + 1e-12


@given(lags, lags, shares)
def test_the_force_loop_has_unit_gain_at_rest(tau_a, tau_b, share_a):
    assert force_dynamics(0j, tau_a, tau_b, share_a) == 1


@given(right_half_plane, lags, lags, shares)
def test_the_force_loop_never_amplifies(s, tau_a, tau_b, share_a):
    assert abs(force_dynamics(s, tau_a, tau_b, share_a)) <= ALMOST_ONE


@given(right_half_plane, lags, shares)
def test_equal_time_constants_make_a_simple_lag(s, tau, share_a):
    found = force_dynamics(s, tau, tau, share_a)
    assert found == pytest.approx(1 / (tau * s + 1), rel=1e-12)


@given(right_half_plane, lags, lags, shares)
def test_both_sides_of_the_cylinder_are_alike(s, tau_a, tau_b, share_a):
    mirrored = force_dynamics(s, tau_b, tau_a, 1 - share_a)
    assert force_dynamics(s, tau_a, tau_b, share_a) == pytest.approx(mirrored, rel=1e-12)


@given(right_half_plane, sample_times)
def test_the_differentiator_is_an_average_of_delays(s, sample_time):
    if abs(s) > 1e-200:  # below, floats lose their digits
        assert abs(differentiator_over_s(s, sample_time)) <= ALMOST_ONE


@given(st.builds(complex, st.floats(-50.0, 500.0), st.floats(10.0, 5e3)), sample_times)
def test_the_differentiator_is_the_sum_of_its_six_taps(s, sample_time):
    terms = TAPS * np.exp(-s * sample_time * np.arange(6)) / sample_time
    found = differentiator_over_s(s, sample_time) * s
    assert abs(found - terms.sum()) <= 1e-12 * np.abs(terms).sum()


@given(right_half_plane, sample_times, st.floats(1e-3, 0.1))
def test_median_and_filter_never_amplify(s, sample_time, time_constant):
    pole = float(np.exp(-sample_time / time_constant))
    assert abs(median_response(s, sample_time)) <= ALMOST_ONE
    assert abs(filter_response(s, sample_time, pole)) <= ALMOST_ONE


@given(st.floats(1e8, 3e9), st.floats(1e8, 3e9), st.floats(1e-6, 1e-2), st.floats(1.0, 100.0))
def test_the_effective_bulk_modulus_lies_between_both_springs_in_series_and_the_oil(
    oil, hose, hose_volume, share
):
    found = effective_bulk_modulus(oil, hose, hose_volume, hose_volume * share)
    assert oil * hose / (oil + hose) * (1 - 1e-12) <= found <= oil * ALMOST_ONE


@given(st.floats(1e-6, 0.999), st.floats(1e-3, 0.1))
def test_the_pressure_time_constant_is_that_of_eq_12(ratio, period):
    tau = float(pressure_time_constant(ratio, 1.0, period))
    assert np.exp(-period / tau) == pytest.approx(1 - ratio, rel=1e-9)


@given(st.floats(0.01, 0.99), st.floats(0.01, 0.99), st.floats(1e-3, 0.1))
def test_a_softer_chamber_is_slower(one, other, period):
    slow, fast = sorted((one, other))
    tau = [float(pressure_time_constant(ratio, 1.0, period)) for ratio in (slow, fast)]
    assert tau[0] >= tau[1]
