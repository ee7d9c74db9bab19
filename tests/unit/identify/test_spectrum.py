"""Spectra of records made from a known force loop."""

import numpy as np
import pytest

from mptune.errors import InputError
from mptune.identify.spectrum import periodic_response, welch_response
from mptune.loops.force_dynamics import force_dynamics

SAMPLE_TIME, PERIOD, PERIODS = 0.5e-3, 4.0, 6
LINES = np.arange(1, 161, 3)
OMEGA = 2 * np.pi * LINES / PERIOD


def known(omega):
    s = 1j * np.asarray(omega)
    return force_dynamics(s, 6e-3, 11e-3, 0.571) * np.exp(-s * 12e-3)


def multisine(noise=0.0, seed=1):
    """Input and output over whole periods: the output is exact line by line."""
    rng = np.random.default_rng(seed)
    phase = rng.uniform(0, 2 * np.pi, len(OMEGA))
    time = SAMPLE_TIME * np.arange(round(PERIODS * PERIOD / SAMPLE_TIME))
    turning = np.exp(1j * (np.outer(time, OMEGA) + phase))
    u, y = turning.real.sum(axis=1), (turning @ known(OMEGA)).real
    return u, y + noise * np.std(y) * rng.standard_normal(len(y))


def test_a_multisine_without_noise_gives_back_its_response():
    u, y = multisine()
    found = periodic_response(u, y, SAMPLE_TIME, OMEGA, PERIODS, "made")
    np.testing.assert_allclose(found.response, known(OMEGA), rtol=1e-9)
    np.testing.assert_allclose(found.quality, 1, atol=1e-12)
    assert found.name == "made"


def test_the_scatter_of_periods_says_how_far_the_response_is_off():
    """The mean of P periods errs by (1/γ² − 1)/P, relative and squared."""
    u, y = multisine(noise=1.0)
    found = periodic_response(u, y, SAMPLE_TIME, OMEGA, PERIODS, "made")
    error = np.abs(found.response / known(OMEGA) - 1) ** 2
    stated = (1 / found.quality - 1) / PERIODS
    assert np.mean(error) == pytest.approx(np.mean(stated), rel=0.5)
    assert 0.8 < np.median(found.quality) < 0.9999


def test_one_period_has_no_coherence_and_a_silent_line_no_response():
    u, y = multisine()
    samples = round(PERIOD / SAMPLE_TIME)
    lines = np.append(OMEGA, 2 * np.pi * 500 / PERIOD)
    found = periodic_response(u[:samples], y[:samples], SAMPLE_TIME, lines, 1, "made")
    assert np.isnan(found.quality).all()
    assert found.valid[:-1].all()
    assert not found.valid[-1]


def test_welch_agrees_with_the_truth():
    rng = np.random.default_rng(3)
    u = rng.standard_normal(120_000)  # 60 s
    frequency = 2 * np.pi * np.fft.rfftfreq(len(u), SAMPLE_TIME)
    y = np.fft.irfft(np.fft.rfft(u) * known(frequency), len(u))
    y += 0.1 * np.std(y) * rng.standard_normal(len(y))
    found = welch_response(u, y, SAMPLE_TIME, "made", band=(2.0, 200.0))
    assert found.omega[0] >= 2
    assert found.omega[-1] <= 200
    error = np.abs(found.response / known(found.omega) - 1)
    assert np.sqrt(np.mean(error**2)) < 0.03
    assert np.median(found.quality) > 0.98


def test_welch_marks_frequencies_without_input():
    from scipy import signal

    rng = np.random.default_rng(4)
    low = signal.sosfiltfilt(
        signal.butter(6, 40, fs=2000, output="sos"), rng.standard_normal(60_000)
    )
    found = welch_response(low, low, SAMPLE_TIME, "made")
    assert found.valid[found.omega < 2 * np.pi * 30].all()
    assert not found.valid[found.omega > 2 * np.pi * 100].any()
    assert np.isnan(found.quality[~found.valid]).all()


def _record(count=4000):
    return np.random.default_rng(0).standard_normal(count)


@pytest.mark.parametrize(
    ("u", "y", "message"),
    [
        (_record(20), _record(20), "too short"),
        (_record(), _record(3000), "3000"),
        (np.ones(4000), _record(), "constant"),
        (np.where(np.arange(4000) == 7, np.nan, _record()), _record(), "first at sample 8"),
        (_record(), np.where(np.arange(4000) == 9, np.inf, _record()), "`output`"),
    ],
)
def test_useless_records_are_refused(u, y, message):
    with pytest.raises(InputError, match=message):
        welch_response(u, y, SAMPLE_TIME, "rig.csv")
    with pytest.raises(InputError, match=message):
        periodic_response(u, y, SAMPLE_TIME, np.array([np.pi]), 1, "rig.csv")


def test_wrong_periods_lines_segments_and_bands_are_refused():
    u = _record()
    with pytest.raises(InputError, match="7 periods"):
        periodic_response(u, u, SAMPLE_TIME, OMEGA, 7, "x")
    with pytest.raises(InputError, match="no line of the record"):
        periodic_response(u, u, SAMPLE_TIME, np.array([4.0]), 1, "x")
    with pytest.raises(InputError, match="segment"):
        welch_response(u, u, SAMPLE_TIME, "x", segment=1.9)
    with pytest.raises(InputError, match="widen"):
        welch_response(u, u, SAMPLE_TIME, "x", band=(1e5, 1e6))
    with pytest.raises(InputError, match="sample time"):
        welch_response(u, u, 0.0, "x")
