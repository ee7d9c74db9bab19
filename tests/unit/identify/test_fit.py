"""Eq. 11 and a dead time recovered from records of a known force loop."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.errors import InputError
from mptune.identify.fit import fit, model
from mptune.identify.fitted import Certainty
from mptune.identify.response import FrequencyResponse
from mptune.identify.spectrum import periodic_response, welch_response

SHARE = 50.27 / (50.27 + 37.70)
SAMPLE_TIME = 0.5e-3
KNOWN = (6e-3, 11e-3, 12e-3)


def made(omega, known=KNOWN, share=SHARE, noise=0.0, seed=0, quality=None):
    """A response of known parameters with relative noise."""
    rng = np.random.default_rng(seed)
    value = model(omega, np.array(known), share)
    off = rng.standard_normal(len(omega)) + 1j * rng.standard_normal(len(omega))
    value = value * (1 + noise * off / np.sqrt(2))
    quality = np.full(len(omega), np.nan) if quality is None else quality
    return FrequencyResponse(np.asarray(omega, float), value, quality, "made")


def multisine_record(known, seed, period=10.0, periods=9):
    """A 90 s record at 20 dB: lines up to 60 Hz, white noise of a tenth of the output's rms."""
    rng = np.random.default_rng(seed)
    lines = np.unique(np.round(np.geomspace(3, 600, 60)))
    omega = 2 * np.pi * lines / period
    spectrum = np.zeros(round(period / SAMPLE_TIME) // 2 + 1, complex)
    spectrum[lines.astype(int)] = np.exp(2j * np.pi * rng.random(len(lines)))
    u = np.fft.irfft(spectrum)
    spectrum[lines.astype(int)] *= model(omega, np.array(known), SHARE)
    y = np.tile(np.fft.irfft(spectrum), periods)
    y += 0.1 * np.std(y) * rng.standard_normal(len(y))
    return np.tile(u, periods), y, omega


def broadband_record(known, seed, seconds=120.0):
    """A 120 s record at 20 dB: noise shaped to 60 Hz as reference."""
    from scipy import signal

    rng = np.random.default_rng(seed)
    count = round(seconds / SAMPLE_TIME)
    sections = signal.butter(4, 60, fs=1 / SAMPLE_TIME, output="sos")
    u = signal.sosfilt(sections, rng.standard_normal(count))
    omega = 2 * np.pi * np.fft.rfftfreq(count, SAMPLE_TIME)
    y = np.fft.irfft(np.fft.rfft(u) * model(omega, np.array(known), SHARE), count)
    return u, y + 0.1 * np.std(y) * rng.standard_normal(count)


CASES = ((6e-3, 11e-3, 12e-3), (11e-3, 6e-3, 12e-3), (4e-3, 10e-3, 20e-3))


@pytest.mark.parametrize("known", CASES)
@pytest.mark.parametrize("kind", ["multisine", "broadband"])
def test_each_parameter_is_found_within_5_percent_at_20_db(known, kind, capsys):
    errors, covered = [], []
    for seed in range(5):
        if kind == "multisine":
            u, y, omega = multisine_record(known, seed)
            response = periodic_response(u, y, SAMPLE_TIME, omega, 9, "made")
        else:
            u, y = broadband_record(known, seed)
            response = welch_response(u, y, SAMPLE_TIME, "made", segment=5.0, band=(1.5, 380.0))
        found = fit(response, SHARE)
        intervals = (found.tau_a, found.tau_b, found.delay)
        errors.append([one.value / true - 1 for one, true in zip(intervals, known, strict=True)])
        covered.append([one.low <= v <= one.high for one, v in zip(intervals, known, strict=True)])
    worst = 100 * np.abs(errors).max(axis=0)
    with capsys.disabled():
        print(
            f"\n{kind}, τ {1e3 * known[0]:g}/{1e3 * known[1]:g} ms, d {1e3 * known[2]:g} ms, "
            f"20 dB, 5 seeds: largest errors τ_A {worst[0]:.2f} %, τ_B {worst[1]:.2f} %, "
            f"d {worst[2]:.2f} %; intervals hold the truth {np.sum(covered)} of 15 times"
        )
    assert np.all(worst < 5)


def test_without_noise_the_parameters_come_back():
    omega = np.geomspace(2, 300, 50)
    for known in CASES:
        found = fit(made(omega, known), SHARE)
        values = (found.tau_a.value, found.tau_b.value, found.delay.value)
        np.testing.assert_allclose(values, known, rtol=1e-5)
        assert found.certainty is Certainty.DETERMINED
        assert found.error < 1e-7


@pytest.mark.compiled  # interpreted, it would take minutes
def test_intervals_hold_the_truth_as_often_as_they_say():
    omega = np.geomspace(2, 300, 60)
    quality = np.full(60, 1 / (1 + 1e-5))
    held = []
    for seed in range(60):
        found = fit(made(omega, noise=0.003, seed=seed, quality=quality), SHARE)
        for one, true in zip((found.tau_a, found.tau_b, found.delay), KNOWN, strict=True):
            held.append(one.low <= true <= one.high)
    assert 0.90 <= np.mean(held) <= 0.99


def test_a_noisy_half_is_outweighed_by_the_coherent_one():
    omega = np.geomspace(2, 300, 80)
    noisy = np.arange(80) % 2 == 1
    quality = np.where(noisy, 0.5, 1 / (1 + 1e-4))
    clean, bad = made(omega, noise=0.01, seed=1), made(omega, noise=1.0, seed=2)
    value = np.where(noisy, bad.response, clean.response)
    found = fit(FrequencyResponse(omega, value, quality, "half"), SHARE)
    assert found.tau_a.value == pytest.approx(KNOWN[0], rel=0.1)
    blind = fit(FrequencyResponse(omega, value, np.full(80, np.nan), "half"), SHARE)
    assert blind.tau_a.high - blind.tau_a.low > 3 * (found.tau_a.high - found.tau_a.low)


def test_equal_areas_leave_the_order_open_and_the_intervals_hold_both():
    found = fit(made(np.geomspace(2, 300, 60), share=0.5, noise=0.003), 0.5)
    assert found.certainty is Certainty.ORDER_UNKNOWN
    for one in (found.tau_a, found.tau_b):
        assert one.low < 6.1e-3
        assert one.high > 10.9e-3
    assert found.delay.value == pytest.approx(KNOWN[2], rel=0.02)


def test_much_noise_is_said_and_never_taken_for_knowledge():
    found = fit(made(np.geomspace(2, 60, 30), noise=0.1, seed=4), SHARE)
    assert found.certainty in {Certainty.ILL_DETERMINED, Certainty.ORDER_UNKNOWN}
    assert found.tau_a.low <= KNOWN[0] <= found.tau_a.high
    assert found.tau_b.low <= KNOWN[1] <= found.tau_b.high
    assert found.tau_a.high < 0.1
    assert "τ_A" in found.weakest


def test_the_weakest_direction_is_the_one_of_largest_variance():
    found = fit(made(np.geomspace(2, 150, 60), noise=0.01), SHARE)
    spread = np.linalg.eigvalsh(found.covariance)[-1]
    stated = float(found.weakest.split("±")[1].split()[0]) * 1e-3
    assert stated == pytest.approx(1.98 * np.sqrt(spread), rel=0.05)


def test_points_without_a_response_and_outside_the_band_are_left_out():
    response = made(np.geomspace(2, 300, 50))
    value = response.response.copy()
    value[:10] = np.nan
    holed = FrequencyResponse(response.omega, value, response.quality, "holed")
    assert fit(holed, SHARE).points == 40
    assert fit(holed, SHARE, (0, 100)).points == np.sum(response.omega[10:] <= 100)
    with pytest.raises(InputError, match="widen the band"):
        fit(holed, SHARE, (290, 400))
