"""Encirclement counts against other routes: polynomial roots, and a brute-force Nyquist curve."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mptune.loops.broken import FORCE, VELOCITY, loop_gain
from mptune.loops.family import FamilyLoops
from mptune.loops.stability import count_unstable_poles
from mptune.params.packed import NO_PATH, LoopGains, MeasurementPath, Plant, Plants

SHARE_A = 4 / 7
FILTERS = MeasurementPath(0.0005, float(np.exp(-0.0005 / 0.012)), 0.012)
SCALE = 50.0  # rad/s: polynomials are written in s/SCALE, which keeps their roots accurate

lags = st.just(0.0) | st.floats(0.5e-3, 0.05)
gains = st.builds(
    LoopGains,
    st.floats(1e3, 1e7),
    st.just(0.0) | st.floats(0.1, 100.0),
    st.just(0.0) | st.floats(0.1, 3000.0),
    st.floats(5.0, 300.0),
    st.floats(0.0, 3.0),
    st.floats(0.001, 0.1),
)


def roots_without_dead_time(which, mass, tau_a, tau_b, gain):
    """Return the roots of the characteristic polynomial of the closed loop, over SCALE."""
    lead = SHARE_A * tau_b + (1 - SHARE_A) * tau_a
    force = np.array([lead * SCALE, 1.0]) * gain.k_p_vel
    plant = np.polymul([tau_a * SCALE, 1], [tau_b * SCALE, 1]) * mass * SCALE  # times s
    s = np.array([1.0, 0.0])
    lag = np.polymul([gain.tau * SCALE, 1], [gain.tau * SCALE, 1])
    shape = [(SCALE / gain.omega) ** 2, 2 * gain.xi * SCALE / gain.omega, 1]
    if which == VELOCITY or gain.k_p_pos == gain.k_i_pos == 0:
        left, right = np.polymul(plant, s), force
    elif gain.k_i_pos == 0:  # one integrator of the controller cancels
        feedback = np.polyadd(np.polymul(s, lag), np.multiply(shape, gain.k_p_pos / SCALE))
        left = np.polymul(np.polymul(plant, s), np.polymul(s, lag))
        right = np.polymul(force, feedback)
    else:
        square = np.polymul(s, s)
        feedback = np.polyadd(np.polymul(square, lag), np.polymul(s, shape) * gain.k_p_pos / SCALE)
        feedback = np.polyadd(feedback, lag * gain.k_i_pos / SCALE**2)
        left = np.polymul(np.polymul(plant, s), np.polymul(square, lag))
        right = np.polymul(force, feedback)
    return np.roots(np.polyadd(left, right))


@pytest.mark.parametrize("which", [VELOCITY, FORCE])
@given(st.floats(1e3, 1e5), lags, lags, gains)
def test_without_dead_time_counts_are_those_of_polynomial_roots(which, mass, tau_a, tau_b, gain):
    roots = roots_without_dead_time(which, mass, tau_a, tau_b, gain)
    assume(np.all(np.abs(roots.real) > 1e-6 * np.abs(roots)))
    plants = Plants(*(np.array([value]) for value in (mass, 0.0, tau_a, tau_b, SHARE_A)))
    count = count_unstable_poles(FamilyLoops(plants, gain, NO_PATH, which))
    assert count.decided.all()
    assert count.unstable.tolist() == [int(np.sum(roots.real > 0))]


def encirclements(loops):
    """Count unstable poles by unwrapping the angle of 1 + L along a very fine Nyquist curve."""
    low, high = 1e-6 * float(loops.radius[0]), 2 * float(loops.tail[0])
    omega = np.geomspace(low, high, 60_000)
    rows = np.zeros(len(omega), np.int64)
    curve = 1 + loops.response(1j * omega, rows)
    turned = np.angle(curve[1:] / curve[:-1]).sum()
    # From the positive real axis to j·low the leading term c/s^k turns by −k π/2.
    turned += np.angle(curve[0] * 1j**loops.integrators) - loops.integrators * np.pi / 2
    turned -= np.angle(curve[-1])
    return -turned / np.pi, np.abs(curve).min()


@pytest.mark.parametrize("path", [NO_PATH, FILTERS], ids=["no path", "filters"])
@pytest.mark.parametrize("which", [VELOCITY, FORCE], ids=["velocity", "force"])
def test_with_dead_time_counts_are_those_of_a_fine_nyquist_curve(which, path):
    random = np.random.default_rng(11)
    seen = set()
    for _ in range(12):
        plant = random.uniform((1e4, 0.0, 0.0, 0.0), (6e4, 0.04, 0.015, 0.015))
        gain = LoopGains(*random.uniform((1e5, 0, 0, 10, 0.2, 2e-3), (4e6, 40, 200, 200, 2, 0.03)))
        plants = Plants(*np.append(plant, SHARE_A)[:, None])
        loops = FamilyLoops(plants, gain, path, which)
        expected, nearest = encirclements(loops)
        count = count_unstable_poles(loops)
        if nearest > 1e-3:
            assert expected == pytest.approx(round(expected), abs=0.01)
            assert count.decided.all()
            assert count.unstable.tolist() == [round(expected)]
            seen.add(round(expected))
    print(f"unstable poles seen: {sorted(seen)}")
    assert len(seen) > 1  # stable and unstable loops alike


@given(
    st.floats(0.1, 2000.0),
    st.floats(-50.0, 50.0),
    st.builds(Plant, st.floats(1e4, 6e4), st.floats(0, 0.03), lags, lags, st.floats(0.5, 0.9)),
    gains,
    st.sampled_from([NO_PATH, FILTERS]),
)
def test_return_differences_multiply(omega, sigma, plant, gain, path):
    # 1 + L_F = (1 + L_v)(1 + L_p): closing both loops at once or one after the other
    s = complex(sigma, omega)
    velocity, position, force = (loop_gain(which, s, plant, gain, path) for which in range(3))
    product = (1 + velocity) * (1 + position)
    scale = 1 + abs(force) + (1 + abs(velocity)) * (1 + abs(position))
    assert abs(1 + force - product) <= 1e-9 * scale
