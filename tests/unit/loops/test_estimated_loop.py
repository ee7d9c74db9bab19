"""The loop around a state estimator, in continuous time and as it runs, by routes of their own."""

import control
import numpy as np
import pytest

from mptune.loops.broken import FORCE, POSITION, VELOCITY, loop_gain
from mptune.loops.estimated import falling_bound, half_rate, tail_of
from mptune.loops.family import FamilyLoops
from mptune.loops.force_dynamics import force_dynamics
from mptune.loops.position import position_controller
from mptune.loops.sampled import coefficient_count, sampled_plant, stable_as_sampled
from mptune.loops.stability import count_unstable_poles
from mptune.params.estimator import place_estimator
from mptune.params.packed import LoopGains, MeasurementPath, Plant, Plants, StateEstimator
from mptune.signals.estimator import estimate
from mptune.signals.states import OUTER_STATES, POSITION_HEARD, VELOCITY_HEARD
from mptune.sim.linear_machine import move_on, stride_of

FAST, PERIOD, LEAST = 5e-4, 0.01, 24_500.0
GAINS = LoopGains(7e5, 13.0, 22.0, 42.0, 0.55, 0.006)
PLANTS = [
    Plant(24_500.0, 0.014, 0.0122, 0.0119, 4 / 7),
    Plant(49_000.0, 0.0112, 0.0001, 0.004, 4 / 7),
    Plant(36_000.0, 0.00537, 0.0, 0.002, 0.5),
]


def path_of(bandwidth=40.0, mass=LEAST):
    return MeasurementPath(FAST, 0.0, 1 / bandwidth, mass, *place_estimator(bandwidth, FAST))


def family_of(plants):
    return Plants(*(np.array(column) for column in zip(*plants, strict=True)))


@pytest.mark.parametrize("plant", PLANTS)
def test_the_loop_is_the_plant_s_around_the_state_space(plant):
    """G_F e^{−sd} (H_F + H_x/(m s²)), H from python-control's state space."""
    path = path_of()
    omega = np.geomspace(0.3, 0.9 * half_rate(path), 50)
    gain = np.array([path.l_1, path.l_2, -path.l_3])
    a = np.array([[1, FAST, -(FAST**2) / 2], [0, 1, -FAST], [0, 0, 1]])
    correct = np.eye(3) - np.outer(gain, [1, 0, 0])
    pushed = np.stack([correct @ [FAST**2 / 2, FAST, 0] / LEAST, gain], axis=1)
    system = control.ss(correct @ a, pushed, (correct @ a)[:2], pushed[:2], FAST)
    heard = system(np.exp(1j * omega * FAST)) * np.exp(-1j * omega * FAST)
    s = 1j * omega
    law = position_controller(s, *GAINS[1:])
    of_force, of_place = heard[1] + law * heard[0]
    force = force_dynamics(s, *plant[2:]) * np.exp(-s * plant.delay)
    expected = GAINS.k_p_vel * force * (of_force + of_place / (plant.mass * s**2))
    found = [loop_gain(FORCE, one, plant, GAINS, path) for one in s]
    np.testing.assert_allclose(found, expected, rtol=1e-7)
    inner, outer = ([loop_gain(which, one, plant, GAINS, path) for one in s]
                    for which in (VELOCITY, POSITION))  # fmt: skip
    np.testing.assert_allclose((1 + np.array(inner)) * (1 + np.array(outer)), 1 + expected)


@pytest.mark.parametrize("plant", PLANTS)
@pytest.mark.parametrize("bandwidth", [25.0, 42.37, 90.0])
def test_the_sampled_plant_is_what_the_kernels_do(plant, bandwidth):
    """A pulse of F_ref, tick by tick through the machine and the estimator's own recursion."""
    path = path_of(bandwidth)
    by = StateEstimator(LEAST, *path[4:], 0.0)
    periods, every = 60, round(PERIOD / FAST)
    delay = plant.delay - PERIOD / 2
    whole = int(delay / FAST + 1e-9)
    within = max(delay - whole * FAST, 0.0)
    strides = [stride_of(plant, length) for length in (within, FAST - within)]
    state, outer, last, applied, found = np.zeros(4), np.zeros(OUTER_STATES), (0.0, 0.0), 0.0, []
    for tick in range(periods * every):
        estimate(outer, by, FAST, *last, 0.0, 0.0)
        last = state[3], plant.share_a * state[0] + (1 - plant.share_a) * state[1]
        if tick % every == 0:
            found.append((outer[POSITION_HEARD], outer[VELOCITY_HEARD]))
        move_on(state, plant, applied, strides[0])
        if tick >= whole and (tick - whole) % every == 0:
            applied = 1.0 if tick == whole else 0.0
        move_on(state, plant, applied, strides[1])
    count = coefficient_count(plant.delay, path, PERIOD)
    sampled = sampled_plant(plant, path, PERIOD, count)
    poles = np.array([1.0])
    for factor in ([1, -1], [1, -1], [1, -sampled.factor_a], [1, -sampled.factor_b], sampled.path):
        poles = np.convolve(poles, factor)
    for numerator, column in zip((sampled.position, sampled.velocity), np.array(found).T,
                                 strict=True):  # fmt: skip
        series = np.zeros(periods)
        for k in range(periods):
            past = sum(poles[i] * series[k - i] for i in range(1, min(k, len(poles) - 1) + 1))
            series[k] = (numerator[k] if k < count else 0.0) - past
        np.testing.assert_allclose(series, column, atol=2e-9 * np.abs(column).max())


@pytest.mark.parametrize("which", [VELOCITY, FORCE])
def test_the_loop_stays_below_its_bound(which):
    path = path_of()
    gains = GAINS if which == FORCE else GAINS._replace(k_p_pos=0.0, k_i_pos=0.0)
    for omega in np.geomspace(45, half_rate(path), 80):
        bound = falling_bound(omega, LEAST, gains, path)
        for higher in np.linspace(omega, half_rate(path), 7):
            gain = loop_gain(which, 1j * higher, PLANTS[0]._replace(tau_a=0, tau_b=0), GAINS, path)
            assert abs(gain) <= bound
    assert falling_bound(tail_of(LEAST, gains, path), LEAST, gains, path) <= 0.5


@pytest.mark.parametrize("plant", PLANTS[:2])
@pytest.mark.parametrize("which", [VELOCITY, FORCE])
def test_counted_poles_flip_where_the_loop_meets_minus_one(plant, which):
    path, omega = path_of(), np.geomspace(1, 600, 40_000)
    gain = np.array([loop_gain(which, 1j * one, plant, GAINS, path) for one in omega])
    crossing = np.flatnonzero((gain.imag[:-1] < 0) & (gain.imag[1:] >= 0) & (gain.real[1:] < 0))
    margin = -1 / gain.real[crossing[0]]
    assert margin > 1
    loops = FamilyLoops(family_of([plant]), GAINS, path, which)
    for factor, stable in ((1.0, True), (0.999 * margin, True), (1.001 * margin, False)):
        count = count_unstable_poles(loops.scaled(factor))
        assert count.decided.all()
        assert count.stable.all() == stable


def test_as_it_runs_it_is_stable_where_the_continuous_loop_is_by_far():
    loops = FamilyLoops(family_of(PLANTS), GAINS, path_of())
    assert stable_as_sampled(loops, PERIOD)[0].all()
    assert not stable_as_sampled(loops.scaled(6.0), PERIOD)[0].all()
