"""What the tuner may choose: each structure is a part of Eq. 22's parameters, within bounds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mptune.errors import InputError
from mptune.loops.position import position_controller
from mptune.robust.model import LinearModel
from mptune.tune.space import STRUCTURES, space_of

LARGEST = 7.1e5  # N s/m
MARGIN = "requirements.gain_margin=1.5"
FREE = ('objective.tracking_loop="sampled"', 'objective.free_feedforward=["acceleration_mass"]')
FREE_LAGS = 'objective.free_feedforward=["reference_lag", "velocity_reference_lag"]'
shares = st.floats(0, 1)
frequencies = st.complex_numbers(min_magnitude=0.1, max_magnitude=500, allow_nan=False)


@pytest.fixture(scope="module")
def space(load_boom):
    """Return the space of a structure under overrides of the boom study."""

    def found(structure="eq22", *overrides, extra=None, largest=LARGEST):
        model = LinearModel.of(load_boom(*overrides, corners=True))
        return space_of(model, largest, structure, extra)

    return found


@pytest.fixture(scope="module")
def spaces(space):
    return {name: space(name, MARGIN) for name in STRUCTURES}


def point_at(space, values):
    """Return the point at shares of each bound."""
    share = np.resize(np.array(values), len(space.names))
    return space.low + share * (space.high - space.low)


def controller(gains, s):
    return position_controller(s, *gains[1:])


@pytest.mark.parametrize("structure", STRUCTURES)
@given(values=st.lists(shares, min_size=6, max_size=6))
def test_a_point_is_its_choices_point(spaces, structure, values):
    space = spaces[structure]
    point = point_at(space, values)
    found = space.choice(space.point(space.choice(point)))
    np.testing.assert_allclose(space.choice(point).gains, found.gains, rtol=1e-7)
    np.testing.assert_allclose(space.point(space.choice(point)), point, atol=1e-7)


@given(values=st.lists(shares, min_size=6, max_size=6), s=frequencies)
def test_p_pi_and_pid_are_exactly_that(spaces, values, s):
    for structure, integral in (("p", 0.0), ("pi", 1.0)):
        space = spaces[structure]
        gains = space.choice(point_at(space, values)).gains
        expected = gains.k_p_pos + integral * gains.k_i_pos / s
        assert controller(gains, s) == pytest.approx(expected, rel=1e-9)
    space = spaces["pid"]
    point = point_at(space, values)
    at = dict(zip(space.names, np.exp(point), strict=True))
    derivative = at["k_d_pos"] * s / (at["tau"] * s + 1)
    expected = at["k_p_pos"] + at["k_i_pos"] / s + derivative
    found = controller(space.choice(point).gains, s)
    size = at["k_p_pos"] + abs(at["k_i_pos"] / s) + abs(derivative)
    assert abs(found - expected) <= 1e-9 * size * max(1, abs(1 / (at["tau"] * s + 1)))


@given(values=st.lists(st.floats(-3, 4), min_size=8, max_size=8))
def test_no_choice_leaves_the_bounds(space_free, values):
    gains, ahead, _ = space_free.choice(point_at(space_free, values))
    assert 22 * (1 - 1e-12) <= gains.k_i_pos <= 200 * (1 + 1e-12)
    assert 0.005 * (1 - 1e-12) <= gains.tau <= 0.03 * (1 + 1e-12)
    assert gains.k_p_vel <= LARGEST * (1 + 1e-12)
    assert 0 <= ahead.acceleration_mass <= 98e3 * (1 + 1e-12)
    low, high = space_free.limits()["k_p_pos"]
    assert low * (1 - 1e-12) <= gains.k_p_pos <= high * (1 + 1e-12)


@pytest.fixture(scope="module")
def space_free(space):
    return space("eq22", MARGIN, *FREE)


def test_the_studys_own_choice_far_outside_is_moved_to_the_bounds(space, load_boom):
    found = space("eq22")
    model = LinearModel.of(load_boom('gains.k_i_pos="5000 1/s^2"', 'gains.tau="1 s"', corners=True))
    point = found.point(found.fixed._replace(gains=model.gains))
    assert np.all((point >= found.low) & (point <= found.high))


@pytest.mark.parametrize(
    ("key", "text", "value"),
    [
        ("tau", '["6 ms", "6 ms"]', 0.006),
        ("k_i_pos", '["0 1/s^2", "0 1/s^2"]', 0.0),
        ("xi", "[0.0, 0.0]", 0.0),
        ("k_p_pos", '["11 1/s", "11 1/s"]', 11.0),
    ],
)
def test_bounds_that_meet_fix_a_parameter(space, key, text, value):
    found = space("eq22", f"requirements.bounds.{key}={text}")
    assert key not in found.names
    assert len(found.names) == 4
    assert found.limits()[key] == (value, value)
    for share in (0.0, 0.3, 1.0):
        assert getattr(found.choice(point_at(found, [share])).gains, key) == value


def test_a_lower_bound_of_zero_stays_a_bound_on_a_logarithm(space):
    found = space("eq22", 'requirements.bounds.k_i_pos=["0 1/s^2", "200 1/s^2"]')
    low, high = found.limits()["k_i_pos"]
    assert 0 < low < 1e-3
    assert high == pytest.approx(200)


def test_extra_bounds_take_the_place_of_the_studys(space):
    found = space("eq22", extra={"k_i_pos": (41.0, 41.0)})
    assert "k_i_pos" not in found.names
    assert found.choice(found.low).gains.k_i_pos == 41.0


BEYOND = {
    "gain_margin": "1.5",
    "sampled_sensitivity_peak": "2.5",
    "sensitivity_peak": "2",
    "complementary_peak": "2",
    "noise_gain": '"34e6 N/m"',
}


@pytest.mark.parametrize("key", BEYOND)
def test_the_velocity_gain_is_free_where_more_than_eq_17_is_asked(space, key):
    found = space("eq22", f"requirements.{key}={BEYOND[key]}")
    assert "k_p_vel" in found.names
    assert found.limits()["k_p_vel"][1] == pytest.approx(LARGEST)


def test_the_velocity_gain_is_the_largest_where_only_the_ratios_are_asked(space):
    found = space("eq22")
    assert "k_p_vel" not in found.names
    assert found.choice(found.high).gains.k_p_vel == LARGEST


def test_feedforward_is_free_where_named_and_may_be_zero(space):
    found = space("eq22", FREE[0], FREE_LAGS, 'feedforward.acceleration_mass="7 t"')
    assert found.names[-2:] == ("reference_lag", "velocity_reference_lag")
    least = found.choice(found.low).feedforward
    assert (least.reference_lag, least.velocity_reference_lag) == (0.0, 0.0)
    assert least.acceleration_mass == 7000.0  # not named: the study's
    assert found.choice(found.high).feedforward.reference_lag == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ('requirements.bounds.k_p_pos=["0 1/s", "0 1/s"]', "no position controller"),
        ('objective={kind="tracking", free_feedforward=["reference_lag"]}', "sampled"),
        ("objective={tracking=1, then=['disturbance']}", "weights and an order"),
        ("objective={tracking=0.0}", "no weight above zero"),
    ],
)
def test_what_makes_no_sense_is_refused_at_once(load_boom, override, words):
    with pytest.raises(InputError, match=words):
        load_boom(override, corners=True)


def test_the_sampled_loop_needs_half_a_sampling_period_of_delay(load_boom):
    asked = ('objective.tracking_loop="sampled"', 'uncertainty.delay_as_it_runs=["4 ms", "14 ms"]')
    with pytest.raises(InputError, match="half a sampling period"):
        load_boom(*asked, corners=True)
    assert load_boom(asked[0], 'uncertainty.delay_as_it_runs=["5 ms", "14 ms"]', corners=True)
