"""What makes the encirclement count certain: each bound a loop states really bounds what it says.

The loop is written a second time here, as the sum of terms that the bounds speak of: Eq. 22 taken
apart into powers of s, and Eq. 23 into the pure delays that it averages.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from mptune.loops.broken import FORCE, VELOCITY
from mptune.loops.family import FamilyLoops
from mptune.loops.stability import count_unstable_poles
from mptune.params.packed import NO_PATH, LoopGains, MeasurementPath, Plants

FILTERS = MeasurementPath(0.0005, float(np.exp(-0.0005 / 0.012)), 0.012)
PUBLISHED = LoopGains(700e3, 13.0, 22.0, 42.0, 0.55, 0.006)
INTEGRAL_ALONE = LoopGains(1e6, 0.0, 3200.0, 42.0, 0.55, 0.006)
BARE = (25e3, 0.0, 0.0, 0.0, 0.57)  # a mass and nothing else: all that remains is the path
WORST = (24.5e3, 0.0215, 0.0122, 0.0119, 4 / 7)
ALMOST_ONE = 1 + 1e-9

lags = st.just(0.0) | st.floats(0.5e-3, 0.05)
plants = st.tuples(st.floats(1e4, 6e4), st.floats(0.0, 0.03), lags, lags, st.floats(0.5, 0.9))
gains = st.builds(
    LoopGains,
    st.floats(1e4, 1e7),
    st.just(0.0) | st.floats(0.1, 100.0),
    st.just(0.0) | st.floats(0.1, 3000.0),
    st.floats(5.0, 300.0),
    st.just(0.0) | st.floats(0.05, 3.0),
    st.floats(0.001, 0.1),
)
paths = st.sampled_from([NO_PATH, FILTERS])
either_loop = pytest.mark.parametrize("which", [VELOCITY, FORCE], ids=["velocity", "force"])


def loops_of(which, plant, gain, path):
    return FamilyLoops(Plants(*(np.array([value]) for value in plant)), gain, path, which)


def averaged_delays(path):
    """Return delays [s] and weights, which add up to 1, that make Eq. 23 over s.

    (5 (1 − z⁵) + 3 (z − z⁴) + z² − z³)/(35 T s), and (zᵃ − zᵇ)/s is the integral of e^{−su} from
    aT to bT: integrated by Gauss's rule, exact to the last digits up to 2000 rad/s.
    """
    nodes, weights = np.polynomial.legendre.leggauss(16)
    spans = [(0.0, 5.0, 5.0), (1.0, 4.0, 3.0), (2.0, 3.0, 1.0)]
    delay = [path.sample_time * (low + (high - low) * (nodes + 1) / 2) for low, high, _ in spans]
    weight = [factor * (high - low) * weights / 2 / 35 for low, high, factor in spans]
    return np.concatenate(delay), np.concatenate(weight)


def terms(which, plant, gain, path, omega):
    """Return the terms that add up to L(jω), ``(terms, F)``."""
    mass, dead_time, tau_a, tau_b, share_a = plant
    s = 1j * np.asarray(omega)
    lead = share_a * tau_b + (1 - share_a) * tau_a
    common = gain.k_p_vel / (mass * s) * (lead * s + 1) / ((tau_a * s + 1) * (tau_b * s + 1))
    common = common * np.exp(-s * dead_time)
    velocity = np.ones((1, len(s)))
    if path.sample_time > 0:
        one_late = np.exp(-s * path.sample_time)
        common = common * one_late * (1 - path.filter_pole) / (1 - path.filter_pole * one_late)
        delay, weight = averaged_delays(path)
        velocity = weight[:, None] * np.exp(-s * delay[:, None])
    if which == VELOCITY:
        return common * velocity
    lag = (gain.tau * s + 1) ** 2
    parts = [s / gain.omega**2, 2 * gain.xi / gain.omega + 0 * s, 1 / s]
    position = [gain.k_p_pos * part / lag for part in parts] + [gain.k_i_pos / s**2]
    return common * np.concatenate([velocity, position])


def at(loops, omega):
    omega = np.asarray(omega, float)
    return loops.response(1j * omega, np.zeros(len(omega), np.int64))


@either_loop
@given(plants, gains, paths, st.floats(0.05, 2000.0))
@example(WORST, PUBLISHED, FILTERS, 60.0)
def test_the_terms_add_up_to_the_loop_and_their_moduli_to_its_bound(which, plant, gain, path, w):
    loops = loops_of(which, plant, gain, path)
    parts = terms(which, plant, gain, path, [w])[:, 0]
    bound = loops.bound(np.array([w]), np.zeros(1, np.int64))[0]
    assert abs(parts.sum() - at(loops, [w])[0]) <= 1e-9 * bound
    assert np.abs(parts).sum() == pytest.approx(bound, rel=1e-9)
    assert abs(at(loops, [w])[0]) <= bound * ALMOST_ONE


@either_loop
@given(plants, gains, paths, st.floats(0.05, 1000.0))
@example(BARE, PUBLISHED, FILTERS, 80.0)  # the path alone
@example((25e3, 0.03, 0.0, 0.0, 0.57), PUBLISHED, NO_PATH, 200.0)  # the delay alone
@example((25e3, 0.0, 0.02, 0.0, 0.9), PUBLISHED, NO_PATH, 30.0)  # a lag alone
@example(BARE, PUBLISHED._replace(tau=0.1), NO_PATH, 80.0)  # Eq. 22's lags
def test_no_term_turns_or_grows_faster_than_the_rate_there_and_beyond(which, plant, gain, path, w):
    loops = loops_of(which, plant, gain, path)
    omega = w * np.array([1.0, 1.1, 2.0, 5.0, 20.0])
    step = 1e-5 * omega
    here, low, high = (
        terms(which, plant, gain, path, omega + sign * step) for sign in (0.0, -1.0, 1.0)
    )
    kept = np.any(here != 0, axis=1)
    speed = np.abs((high - low)[kept] / here[kept]) / (2 * step)
    rate = loops.rate(np.array([w]), np.zeros(1, np.int64))[0]
    assert speed.max() <= rate * (1 + 1e-5)


@either_loop
@given(plants, gains, paths, st.floats(0.05, 2000.0), st.floats(1e-6, 1.0))
@example(BARE, PUBLISHED, FILTERS, 83.0, 1e-3)  # the path alone, as fast as its filter turns it
@example((25e3, 0.03, 0.0, 0.0, 0.57), PUBLISHED, NO_PATH, 200.0, 1e-3)
@example(WORST, PUBLISHED, FILTERS, 55.0, 0.1)
def test_over_a_step_the_loop_moves_no_further_than_its_bounds_say(
    which, plant, gain, path, w, share
):
    loops, row, step = loops_of(which, plant, gain, path), np.zeros(1, np.int64), share * w
    growth = np.expm1(min(loops.rate(np.array([w]), row)[0] * step, 50.0))
    bound = loops.bound(np.array([w]), row)[0]
    values = at(loops, w + step * np.linspace(0, 1, 9))
    # Where S far exceeds |L| or the step is tiny the rounding of L itself is what is left over.
    assert np.abs(values - values[0]).max() <= bound * growth * (1 + 1e-6) + 1e-12 * bound


@either_loop
@given(
    st.tuples(
        st.floats(1e4, 6e4), st.floats(0, 0.02), *[st.floats(5e-3, 0.05)] * 2, st.floats(0.5, 0.9)
    ),
    gains,
    paths,
)
@example((25e3, 0.0, 0.0, 0.0, 0.57), PUBLISHED, FILTERS)  # the filter's pole is the only lag
@example((25e3, 0.0, 0.04, 0.005, 0.57), PUBLISHED, NO_PATH)  # τ_A the slowest
@example((25e3, 0.0, 0.005, 0.04, 0.57), PUBLISHED, NO_PATH)  # τ_B
@example((25e3, 0.0, 0.005, 0.005, 0.57), PUBLISHED._replace(tau=0.05), NO_PATH)  # Eq. 22's
def test_within_its_radius_the_loop_has_no_pole_but_the_origin_s(which, plant, gain, path):
    """Then L s^k is its value at the origin on average over the circle (Cauchy)."""
    loops = loops_of(which, plant, gain, path)
    radius = min(float(loops.radius[0]), 300.0)  # rad/s; e^{−sd} would swamp all else beyond
    s = radius * np.exp(2j * np.pi * np.arange(600) / 600)
    values = loops.response(s, np.zeros(len(s), np.int64)) * s**loops.integrators
    assert values.mean() == pytest.approx(loops.leading[0], abs=1e-9 * np.abs(values).max())


@either_loop
@given(plants, gains, paths)
@example((25e3, 0.0, 0.0, 0.0, 0.57), INTEGRAL_ALONE, NO_PATH)  # on the real axis |L| is its bound
@example(WORST, PUBLISHED, FILTERS)
def test_beyond_its_tail_the_loop_is_at_most_one_half_in_the_right_half_plane(
    which, plant, gain, path
):
    loops = loops_of(which, plant, gain, path)
    size = loops.tail[0] * np.array([1.0, 1.01, 1.1, 1.5, 2.0, 4.0, 10.0, 50.0])
    size = size[size < 5e5]  # rad/s; beyond, Eq. 23's pairs overflow off the imaginary axis
    s = (size[:, None] * np.exp(1j * np.linspace(-np.pi / 2, np.pi / 2, 33))).ravel()
    s.real = np.maximum(s.real, 0.0)
    values = loops.response(s, np.zeros(len(s), np.int64))
    assert np.abs(values).max(initial=0.0) <= 0.5 * ALMOST_ONE


class Watched:
    """A loop that remembers the frequencies of the imaginary axis at which it was asked for L."""

    def __init__(self, loops):
        self._loops = loops
        self.seen = set()

    def __getattr__(self, name):
        return getattr(self._loops, name)

    def response(self, s, rows):
        self.seen.update(s.imag[s.real == 0].tolist())
        return self._loops.response(s, rows)


@either_loop
@given(plants, gains, paths)
@example(WORST, PUBLISHED, NO_PATH)
@example(WORST, PUBLISHED, FILTERS)
def test_every_step_of_the_contour_is_certified(which, plant, gain, path):
    """A step that is split is asked for in its middle: the steps lie between what was asked for."""
    loops = Watched(loops_of(which, plant, gain, path))
    count = count_unstable_poles(loops)
    omega = np.array(sorted(loops.seen))
    low, step = omega[:-1], np.diff(omega)
    rows = np.zeros(len(low), np.int64)
    growth = np.expm1(np.minimum(loops.rate(low, rows) * step, 50.0))
    certified = loops.bound(low, rows) * growth < np.abs(1 + at(loops, low))
    assert omega[-1] >= loops.tail[0]
    assert certified.all() or not count.decided[0]
