"""The noise gain against impulse sums and a long random run, both with scipy's filters."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import cont2discrete, lfilter

from mptune.loops.noise import noise_gain
from mptune.params.pack import LoopGains, MeasurementPath

PERIOD = 0.01
GAINS = LoopGains(700e3, 13.0, 22.0, 42.0, 0.55, 0.006)
TAPS = np.array([5, 3, 1, -1, -3, -5]) / 35


def path_of(ticks=20, filter_time=0.012):
    fast = PERIOD / ticks
    return MeasurementPath(fast, float(np.exp(-fast / filter_time)), filter_time)


def force_of(noise, gains, path):
    """Return F_ref [N] at each decision, of position noise ``(…, T)`` [m] at the fast ticks."""
    pole, ticks = path.filter_pole, round(PERIOD / path.sample_time)
    filtered = lfilter([0.0, 1 - pole], [1.0, -pole], noise)  # median: one sample
    velocity = lfilter(TAPS / path.sample_time, [1.0], filtered)[..., ::ticks]
    law = gains.k_p_pos * np.array([1 / gains.omega**2, 2 * gains.xi / gains.omega, 1.0])
    lag = np.polymul([gains.tau, 1], [gains.tau, 1])
    upper, lower, _ = cont2discrete((law, lag), PERIOD, "bilinear")
    return gains.k_p_vel * (velocity + lfilter(upper.ravel(), lower, filtered[..., ::ticks]))


def by_impulses(gains, path, periods=400):
    """Return the root of the summed squares of what a noise sample does, over its instants."""
    ticks = round(PERIOD / path.sample_time)
    impulses = np.zeros((ticks, ticks * periods))
    impulses[np.arange(ticks), np.arange(ticks)] = 1.0
    return np.sqrt(np.sum(force_of(impulses, gains, path) ** 2))


CASES = {
    "published": (GAINS, path_of()),
    "one tick per decision": (GAINS, path_of(ticks=1)),
    "three ticks, short filter": (GAINS, path_of(ticks=3, filter_time=0.001)),
    "ringing lag": (GAINS._replace(tau=0.001), path_of()),
    "slow lag": (GAINS._replace(tau=0.08), path_of()),
    "no damping term": (GAINS._replace(xi=0.0), path_of()),
    "velocity alone": (GAINS._replace(k_p_pos=0.0), path_of()),
}


@pytest.mark.parametrize("case", CASES)
def test_it_is_the_root_of_the_impulses_squares(case):
    gains, path = CASES[case]
    found, expected = noise_gain(gains, path, PERIOD), by_impulses(gains, path)
    print(f"{case}: {found:.6g} N/m, by impulses {expected:.6g} N/m")
    assert found == pytest.approx(expected, rel=1e-8)


def test_a_long_random_run_has_its_rms():
    gains, path = CASES["published"]
    noise = np.random.default_rng(5).normal(size=20 * 100_000)
    force = force_of(noise, gains, path)[100:]
    measured = np.sqrt(np.mean(force**2))
    print(f"{measured:.4g} N/m in 1000 s, {noise_gain(gains, path, PERIOD):.4g} N/m")
    assert measured == pytest.approx(noise_gain(gains, path, PERIOD), rel=0.02)


@given(
    factor=st.floats(0.01, 100.0),
    k_p_pos=st.floats(0.0, 50.0),
    omega=st.floats(5.0, 200.0),
    xi=st.floats(0.0, 2.0),
    tau=st.floats(0.001, 0.1),
)
def test_it_is_linear_in_the_velocity_gain_and_knows_no_integral_term(
    factor, k_p_pos, omega, xi, tau
):
    gains = LoopGains(700e3, k_p_pos, 22.0, omega, xi, tau)
    once = noise_gain(gains, path_of(), PERIOD)
    scaled = gains._replace(k_p_vel=factor * gains.k_p_vel, k_i_pos=0.0)
    assert noise_gain(scaled, path_of(), PERIOD) == pytest.approx(factor * once, rel=1e-12)


def test_a_slower_filter_lets_less_noise_through():
    gains = [noise_gain(GAINS, path_of(filter_time=t), PERIOD) for t in (1e-3, 4e-3, 12e-3, 0.05)]
    assert np.all(np.diff(gains) < 0)


def test_a_lead_at_lower_frequency_and_more_damping_of_it_let_more_noise_through():
    by_omega = [noise_gain(GAINS._replace(omega=w), path_of(), PERIOD) for w in (80, 42, 20, 10)]
    by_gain = [noise_gain(GAINS._replace(k_p_pos=k), path_of(), PERIOD) for k in (0, 5, 13, 40)]
    assert np.all(np.diff(by_omega) > 0)
    assert np.all(np.diff(by_gain) > 0)
