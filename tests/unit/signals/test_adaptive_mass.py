"""The mass that is learnt on line: found, held within its bounds, frozen at rest."""

import numpy as np
import pytest

from mptune.params.packed import FeedforwardTuple
from mptune.signals.adaptive_mass import (
    ACCELERATION_UNIT,
    FIRST_COVARIANCE,
    FORGETTING,
    VELOCITY_UNIT,
    fed_mass,
    learn_mass,
    start_learning,
)
from mptune.signals.states import COVARIANCE, FACTORS, LAST_VELOCITY_REFERENCE, MASS, OUTER_STATES
from mptune.signals.trajectory import quintic, reference

FAST = 5e-4
AHEAD = FeedforwardTuple(
    37e3, 0.0, 0.0, friction_velocity=2e-3, adaptive=1.0, mass_least=24.5e3, mass_largest=49e3,
    regressor_pole=0.0, sample_time=FAST,
)  # fmt: skip


def learnt(mass, ahead=AHEAD, moves=3, noise=0.0, seed=0):
    """The state after some moves of a machine that does exactly what its reference asks."""
    state, random = np.zeros(OUTER_STATES), np.random.default_rng(seed)
    start_learning(state, ahead, 9e3)
    for number in range(moves):
        pieces = quintic((-1.0) ** number * 0.07, 1.25)
        for tick in range(2500):
            _, speed, _ = reference(tick * FAST, pieces)
            rise = (speed - state[LAST_VELOCITY_REFERENCE]) / FAST
            sign = speed / np.hypot(speed, ahead.friction_velocity)
            force = mass * rise + 4e3 * speed + 700 * sign + 9.7e3 + noise * random.normal()
            learn_mass(state, ahead, force, speed)
            state[LAST_VELOCITY_REFERENCE] = speed
    return state


@pytest.mark.parametrize("mass", [25e3, 36e3, 48e3])
def test_the_mass_is_found(mass):
    state = learnt(mass, moves=6)
    assert fed_mass(state, AHEAD) == pytest.approx(mass, rel=2e-3)
    factors = state[FACTORS : FACTORS + 4]
    assert factors[1] / VELOCITY_UNIT == pytest.approx(4e3, rel=0.05)
    assert factors[3] == pytest.approx(9.7e3, rel=0.01)


def test_noise_of_the_pressures_moves_it_little():
    assert fed_mass(learnt(36e3, moves=6, noise=500.0), AHEAD) == pytest.approx(36e3, rel=0.02)


@pytest.mark.parametrize(("mass", "held"), [(10e3, 24.5e3), (80e3, 49e3)])
def test_it_is_held_within_the_family_s(mass, held):
    state = learnt(mass, moves=6)
    assert state[MASS] == held
    assert state[FACTORS] / ACCELERATION_UNIT == pytest.approx(mass, rel=5e-3)


def test_nothing_is_learnt_at_rest():
    state = learnt(30e3)
    before = state.copy()
    for _ in range(20_000):
        learn_mass(state, AHEAD, 1e5, 0.0)
        state[LAST_VELOCITY_REFERENCE] = 0.0
    np.testing.assert_array_equal(state[FACTORS:], before[FACTORS:])
    assert state[MASS] == before[MASS]


def test_a_fixed_mass_is_fed_as_it_is():
    assert fed_mass(np.zeros(OUTER_STATES), AHEAD._replace(adaptive=0.0)) == 37e3


def test_what_is_not_known_of_the_mass_grows_no_further_than_at_the_start():
    state = np.zeros(OUTER_STATES)
    start_learning(state, AHEAD, 9e3)
    for _ in range(3000):
        learn_mass(state, AHEAD, 10e3, 0.05)
        state[LAST_VELOCITY_REFERENCE] = 0.05
        assert state[COVARIANCE] <= FIRST_COVARIANCE[0] / FORGETTING


@pytest.mark.compiled  # interpreted, it would take minutes
def test_steady_motion_without_acceleration_forgets_no_further_than_the_start():
    state = learnt(30e3)
    for _ in range(200_000):
        learn_mass(state, AHEAD, 10e3, 0.05)
        state[LAST_VELOCITY_REFERENCE] = 0.05
    assert np.isfinite(state).all()
    assert state[FACTORS] / ACCELERATION_UNIT == pytest.approx(30e3, rel=0.05)
