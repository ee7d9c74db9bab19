"""The state estimator: its gains, its recursion, and both against the state space."""

import control
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mptune.params.estimator import place_estimator
from mptune.params.packed import MeasurementPath, StateEstimator
from mptune.signals.estimator import estimate, heard, heard_along
from mptune.signals.states import LOAD_HEARD, OUTER_STATES, POSITION_HEARD, VELOCITY_HEARD

FAST = 5e-4
MASS = 24_500.0


def estimator_of(bandwidth, injected=0.0, mass=MASS):
    return StateEstimator(mass, *place_estimator(bandwidth, FAST), injected)


def matrices(by):
    """A of the prediction, B of the force over m̂, and L, in position, velocity and d̂/m̂."""
    prediction = np.array([[1, FAST, -(FAST**2) / 2], [0, 1, -FAST], [0, 0, 1]])
    return prediction, np.array([FAST**2 / 2, FAST, 0]), np.array([by.l_1, by.l_2, -by.l_3])


def test_the_gains_of_a_known_bandwidth():
    """Figures of an independent trial, whose bandwidth is printed as 42.4 rad/s."""
    gains = place_estimator(42.37, FAST)
    assert gains == pytest.approx((0.041486, 1.7577, 37.235), rel=5e-5)


@given(bandwidth=st.floats(1, 500))
def test_the_error_s_poles_are_butterworth_s(bandwidth):
    a, _, gain = matrices(estimator_of(bandwidth))
    poles = np.linalg.eigvals((np.eye(3) - np.outer(gain, [1, 0, 0])) @ a)
    angles = np.array([np.pi, 2 * np.pi / 3, -2 * np.pi / 3])
    wanted = np.exp(bandwidth * FAST * np.exp(1j * angles))
    found = np.array([poles[np.argmin(np.abs(poles - one))] for one in wanted])
    np.testing.assert_allclose(found, wanted, atol=1e-6)


@pytest.mark.parametrize("bandwidth", [15.0, 42.37, 120.0])
def test_the_responses_are_those_of_the_state_space(bandwidth):
    """Against python-control, whose inputs are both medians' outputs, one sample late."""
    by = estimator_of(bandwidth)
    a, b, gain = matrices(by)
    correct = np.eye(3) - np.outer(gain, [1, 0, 0])
    moved, pushed = correct @ a, np.stack([gain, correct @ b / MASS], axis=1)
    # x(k) = M x(k−1) + N u(k): the input acts at once, so that the output is M x + N u.
    system = control.ss(moved, pushed, moved[:2], pushed[:2], FAST)
    omega = np.geomspace(0.5, 0.95 * np.pi / FAST, 60)
    expected = system(np.exp(1j * omega * FAST)) * np.exp(-1j * omega * FAST)
    path = MeasurementPath(FAST, 0.0, 1 / bandwidth, MASS, by.l_1, by.l_2, by.l_3)
    found = heard_along(1j * omega, path)
    np.testing.assert_array_equal(found.T, [heard(1j * one, path) for one in omega])
    rows = [expected[0, 0], expected[1, 0], expected[0, 1], expected[1, 1]]
    for one, other in zip(found, rows, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-7)


def test_at_low_frequency_it_hears_what_there_is():
    path = MeasurementPath(FAST, 0.0, 1 / 40, MASS, *estimator_of(40.0)[1:4])
    found = heard(0.01j, path)
    assert found.place_of_place == pytest.approx(np.exp(-0.01j * FAST), rel=1e-8)
    assert found.speed_of_place == pytest.approx(0.01j, rel=1e-4)


@given(
    mass=st.floats(2e4, 5e4), load=st.floats(-1e4, 1e4), speed=st.floats(-0.1, 0.1),
    bandwidth=st.floats(30, 100),
)  # fmt: skip
def test_it_settles_on_the_truth_whatever_it_believes_of_the_mass(mass, load, speed, bandwidth):
    """At constant speed under a constant load nothing of the mass is left to be wrong."""
    by, state = estimator_of(bandwidth, mass=mass), np.zeros(OUTER_STATES)
    for tick in range(3000):
        place = 0.1 + speed * tick * FAST
        estimate(state, by, FAST, place, load, 0.0, 0.0)
    assert state[POSITION_HEARD] == pytest.approx(place, abs=1e-7)
    assert state[VELOCITY_HEARD] == pytest.approx(speed, abs=1e-6)
    assert state[LOAD_HEARD] == pytest.approx(load, abs=1.0)


@pytest.mark.parametrize("injected", [0.0, 1.0])
def test_an_injected_reference_makes_up_for_a_wrong_mass(injected):
    """A machine of the feed-forward's mass that follows its reference is heard without error."""
    by, state = estimator_of(40.0, injected), np.zeros(OUTER_STATES)
    mass, acceleration, worst = 4e4, 0.2, 0.0
    for tick in range(1, 1000):
        time = tick * FAST
        speed = acceleration * time
        estimate(state, by, FAST, speed * time / 2, mass * acceleration, speed, mass)
        state[10] = speed
        worst = max(worst, abs(state[VELOCITY_HEARD] - speed))
    assert bool(worst < 1e-12) is bool(injected)
