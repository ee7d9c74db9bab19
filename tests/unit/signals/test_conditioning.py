"""Median and first-order filter: their responses against the filters themselves, run in time."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.params.pack import pack_filters
from mptune.signals.conditioning import filter_response, median_response

SAMPLE = 0.0005


def steady_response(signal, omega):
    """Fit a sine to the second half of a filtered cosine, where the start has died away."""
    time = SAMPLE * np.arange(len(signal))
    late = time > time[-1] / 2
    basis = np.stack([np.cos(omega * time[late]), -np.sin(omega * time[late])], axis=1)
    (real, imaginary), *_ = np.linalg.lstsq(basis, signal[late], rcond=None)
    return complex(real, imaginary)


@pytest.mark.parametrize("omega", [20.0, 80.0, 1000.0])
def test_the_filter_s_response_is_that_of_its_recursion(omega):
    pole = np.exp(-SAMPLE / 0.012)
    wave = np.cos(omega * SAMPLE * np.arange(8000))
    filtered = np.empty_like(wave)
    state = 0.0
    for k, value in enumerate(wave):
        state = pole * state + (1 - pole) * value
        filtered[k] = state
    expected = steady_response(filtered, omega)
    assert filter_response(1j * omega, SAMPLE, pole) == pytest.approx(expected, rel=1e-9)


def test_the_filter_passes_a_constant_unchanged():
    assert filter_response(0j, SAMPLE, 0.96) == pytest.approx(1, rel=1e-14)


def test_the_filter_lags_by_about_its_time_constant(boom):
    path = pack_filters(boom.study.controller)
    delay = -np.angle(filter_response(0.1j, path.sample_time, path.filter_pole)) / 0.1
    assert delay == pytest.approx(0.012, abs=SAMPLE)
    assert path.filter_time == 0.012


def test_a_median_passes_a_ramp_one_sample_late():
    ramp = np.arange(10.0)
    filtered = [np.median(ramp[k - 2 : k + 1]) for k in range(2, 10)]
    np.testing.assert_array_equal(filtered, ramp[1:9])


def test_the_median_s_response_is_one_sample_of_delay():
    assert median_response(100j, SAMPLE) == pytest.approx(np.exp(-100j * SAMPLE), rel=1e-15)
