"""The outer loops' law: linear as Eq. 22 says, and what is not linear in it by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import cont2discrete, dlsim, dlti

from mptune.params.packed import FeedforwardTuple, LoopGains
from mptune.signals import outer_loop as outer
from mptune.signals.states import OUTER_STATES

GAINS = LoopGains(7e5, 13.0, 22.0, 42.0, 0.55, 0.006)
PERIOD = 0.01
PLAIN = FeedforwardTuple(0.0, 0.0, 0.0)


def law_of(gains=GAINS, ahead=PLAIN, dead_zone=0.0, limits=outer.NO_LIMITS):
    return outer.outer_law(gains, ahead, PERIOD, dead_zone, limits)


def at_rest(reference=0.0):
    state = np.zeros(OUTER_STATES)
    state[outer.REFERENCE] = reference
    return state


@given(
    k_p=st.floats(0.5, 50), k_i=st.floats(0, 100), tau=st.floats(0.002, 0.05), seed=st.integers(0)
)
def test_it_is_eq_22_under_tustin_inside_eq_18(k_p, k_i, tau, seed):
    """Against scipy's bilinear transform, with velocities on top."""
    gains = GAINS._replace(k_p_pos=k_p, k_i_pos=k_i, tau=tau)
    random = np.random.default_rng(seed)
    errors, wanted, measured = random.normal(size=(3, 60))
    shape = k_p * np.array([1 / gains.omega**2, 2 * gains.xi / gains.omega, 1.0])
    lags = np.array([tau**2, 2 * tau, 1.0])
    numerator = np.polyadd(np.polymul(shape, [1, 0]), k_i * lags)
    system = cont2discrete((numerator, np.polymul(lags, [1, 0])), PERIOD, method="bilinear")
    shaped = dlsim(dlti(np.squeeze(system[0]), system[1], dt=PERIOD), errors)[1][:, 0]
    expected = gains.k_p_vel * (wanted + shaped - measured)
    law, state, found = law_of(gains), at_rest(), []
    for error, v_ref, velocity in zip(errors, wanted, measured, strict=True):
        state[outer.REFERENCE], state[outer.VELOCITY_REFERENCE] = error, v_ref
        found.append(outer.force_reference(state, law, 0.0, velocity, 0.0))
    np.testing.assert_allclose(found, expected, atol=1e-8 * np.abs(expected).max())


def test_acceleration_counts_by_its_mass():
    law = law_of(ahead=FeedforwardTuple(2e4, 0.0, 0.0))
    state = at_rest(0.15)
    assert outer.force_reference(state, law, 0.15, 0.0, 1.5) == pytest.approx(3e4)


@pytest.mark.parametrize(("error", "grows"), [(0.9e-4, False), (1.1e-4, True)])
def test_the_integrator_stands_still_inside_the_dead_zone(error, grows):
    law, state = law_of(dead_zone=1e-4), at_rest(error)
    outer.force_reference(state, law, 0.0, 0.0, 0.0)
    assert bool(state[outer.INTEGRAL] > 0) is grows
    assert state[outer.LAST_ERROR] == error  # the next trapezoid begins here all the same


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_at_its_limit_the_force_reference_winds_nothing_up(side):
    law, state = law_of(limits=(-5e4, 9e4)), at_rest(side * 0.1)
    force = outer.force_reference(state, law, 0.0, 0.0, 0.0)
    assert force == state[outer.FORCE] == (9e4 if side > 0 else -5e4)
    assert state[outer.INTEGRAL] == 0


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_at_its_limit_the_integrator_may_come_back(side):
    """The error has turned while velocity holds the force at its limit."""
    law, state = law_of(limits=(-5e4, 9e4)), at_rest(-side * 1e-3)
    outer.force_reference(state, law, 0.0, -side * 1.0, 0.0)
    assert state[outer.FORCE] == (9e4 if side > 0 else -5e4)
    assert state[outer.INTEGRAL] * side < 0


def test_references_pass_their_lags_and_without_any_arrive_at_once():
    pole = float(np.exp(-0.0005 / 0.012))
    law = law_of(ahead=FeedforwardTuple(0.0, pole, 0.0))
    state = at_rest()
    for _ in range(24):  # one time constant
        outer.lag_references(state, law, 1.0, 2.0)
    assert state[outer.REFERENCE] == pytest.approx(1 - np.exp(-1))
    assert state[outer.VELOCITY_REFERENCE] == 2.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_friction_is_fed_forward_along_the_reference(sign):
    """By hand: 3000 N s/m · 50 mm/s + 600 N, and at v_s 1/√2 of the latter."""
    ahead = PLAIN._replace(viscous_friction=3e3, coulomb_friction=600.0, friction_velocity=2e-3)
    assert outer.friction_ahead(sign * 0.05, ahead) == pytest.approx(sign * 749.5, abs=0.1)
    turn = outer.friction_ahead(sign * 2e-3, ahead)
    assert turn == pytest.approx(sign * (6.0 + 600 / np.sqrt(2)))
    assert outer.friction_ahead(0.0, ahead) == 0.0
