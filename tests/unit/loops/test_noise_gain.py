"""The noise gain against an integral of its own formulas, and against long random runs."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.signal import cont2discrete, lfilter

from mptune.loops.noise import noise_gain
from mptune.params.packed import LoopGains, MeasurementPath

GAINS = LoopGains(700e3, 13.0, 22.0, 42.0, 0.55, 0.006)
TAPS = np.array([5, 3, 1, -1, -3, -5]) / 35
FAST = 5e-4


def path_of(filter_time=0.012, fast=FAST):
    return MeasurementPath(fast, float(np.exp(-fast / filter_time)), filter_time)


def by_integral(gains, path):
    """Return the root of the mean of |K (G_P + Eq. 23) H|² over the fast rate's frequencies."""
    fast, pole = path.sample_time, path.filter_pole

    def square(omega):
        s, z = 1j * omega, np.exp(-1j * omega * fast)
        shape = s**2 / gains.omega**2 + 2 * gains.xi * s / gains.omega + 1
        controller = gains.k_p_pos * shape / (gains.tau * s + 1) ** 2
        velocity = np.sum(TAPS * z ** np.arange(6)) / fast
        return abs(gains.k_p_vel * (controller + velocity) * (1 - pole) / (1 - pole * z)) ** 2

    edges = np.concatenate([[0.0], np.geomspace(1.0, np.pi / fast, 8)])
    total = sum(quad(square, a, b, limit=200)[0] for a, b in pairwise(edges))
    return np.sqrt(total * fast / np.pi)


CASES = {
    "published": (GAINS, path_of()),
    "short filter": (GAINS, path_of(filter_time=0.001)),
    "fast sampling": (GAINS, path_of(fast=1e-4)),
    "short lag": (GAINS._replace(tau=0.001), path_of()),
    "slow lag": (GAINS._replace(tau=0.08), path_of()),
    "no damping term": (GAINS._replace(xi=0.0), path_of()),
    "velocity alone": (GAINS._replace(k_p_pos=0.0), path_of()),
}


@pytest.mark.parametrize("case", CASES)
def test_it_is_the_root_of_the_mean_square_over_frequency(case):
    gains, path = CASES[case]
    found, expected = noise_gain(gains, path), by_integral(gains, path)
    print(f"{case}: {found:.6g} N/m, by integral {expected:.6g} N/m")
    assert found == pytest.approx(expected, rel=1e-4)


def test_a_long_random_run_of_the_continuous_controller_has_its_rms():
    """Every part runs at T_S,fast, where Tustin's approximation is nearly the controller itself."""
    path = path_of()
    noise = np.random.default_rng(5).normal(size=1_000_000)
    pole = path.filter_pole
    filtered = lfilter([0.0, 1 - pole], [1.0, -pole], noise)  # median: one sample
    velocity = lfilter(TAPS / FAST, [1.0], filtered)
    law = GAINS.k_p_pos * np.array([1 / GAINS.omega**2, 2 * GAINS.xi / GAINS.omega, 1.0])
    lag = np.polymul([GAINS.tau, 1], [GAINS.tau, 1])
    upper, lower, _ = cont2discrete((law, lag), FAST, "bilinear")
    force = GAINS.k_p_vel * (velocity + lfilter(upper.ravel(), lower, filtered))
    measured = np.sqrt(np.mean(force[1000:] ** 2))
    print(f"{measured:.4g} N/m in 500 s, {noise_gain(GAINS, path):.4g} N/m")
    assert measured == pytest.approx(noise_gain(GAINS, path), rel=0.02)


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
    once = noise_gain(gains, path_of())
    scaled = gains._replace(k_p_vel=factor * gains.k_p_vel, k_i_pos=0.0)
    assert noise_gain(scaled, path_of()) == pytest.approx(factor * once, rel=1e-12)


def test_a_slower_filter_lets_less_noise_through():
    gains = [noise_gain(GAINS, path_of(filter_time=t)) for t in (1e-3, 4e-3, 12e-3, 0.05)]
    assert np.all(np.diff(gains) < 0)


def test_a_lead_at_lower_frequency_lets_more_noise_through():
    by_omega = [noise_gain(GAINS._replace(omega=w), path_of()) for w in (80, 42, 20, 10)]
    assert np.all(np.diff(by_omega) > 0)
