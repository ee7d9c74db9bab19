"""A study's linear model: what is packed, and which loops it gives."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.loops.broken import FORCE, VELOCITY
from mptune.loops.family import plants_of
from mptune.params.packed import NO_PATH, LoopGains, NominalPlant
from mptune.robust.condition import sides
from mptune.robust.model import PATHS, LinearModel

PUBLISHED = LoopGains(700e3, 13.0, 22.0, 42.0, 0.55, 0.006)
S = 1j * np.array([2.0, 30.0, 200.0])
ROWS = np.zeros(3, np.int64)


@pytest.fixture(scope="module")
def model(load_boom):
    return LinearModel.of(load_boom("uncertainty.points=3"))


@pytest.fixture
def measured(load_measured):
    """The model with a response that is measured within a band, beside the box or instead."""
    omega = np.geomspace(1.0, 600.0, 200)
    force = np.exp(-0.026j * omega) / (1 + 0.012j * omega)
    return lambda place: LinearModel.of(load_measured(omega, force, place=place))


def position_controller(s):
    """Eq. 22 with the published gains, written for the test."""
    shape = (s / 42) ** 2 + 2 * 0.55 * s / 42 + 1
    return 13 * shape / (0.006 * s + 1) ** 2 + 22 / s


def nominal_by_hand(s):
    """Eq. 14 with K_P,vel: the nominal velocity loop without a measurement path."""
    return 700e3 * np.exp(-0.011 * s) / (24500 * s)


# What is packed ---------------------------------------------------------------------------------


def test_what_the_study_says_is_packed_in_si(model):
    assert model.gains == PUBLISHED
    assert model.nominal == NominalPlant(24500.0, 0.011)
    assert model.limits == (0.65, 0.48)
    assert model.period == 0.010
    assert model.plants.number == 3**4
    assert set(model.plants.share_a) == {model.study.study.share_a}
    assert model.requirements is model.study.study.requirements


def test_the_chosen_uncertainty_set_makes_the_plants(load_boom):
    plants = LinearModel.of(load_boom(uncertainty="section-5-1", corners=True)).plants
    assert (plants.delay.min(), plants.delay.max()) == (0.010, 0.014)


def test_the_path_as_it_runs_is_the_controllers_filter(model):
    path = model.path_of("filters")
    assert path == model.filters
    assert (path.sample_time, path.filter_time) == (0.0005, 0.012)
    assert path.filter_pole == pytest.approx(np.exp(-0.0005 / 0.012), rel=1e-15)
    assert model.path_of("none") == NO_PATH
    assert set(PATHS) == {"none", "filters"}


@pytest.mark.parametrize("name", PATHS)
def test_the_inequalities_have_the_path_that_the_study_names(load_boom, name):
    model = LinearModel.of(load_boom(f"model.measurement_path={name}", corners=True))
    assert model.path == model.path_of(name)
    assert model.filters == model.path_of("filters")


@pytest.mark.parametrize(("shortest", "runs"), [("4.99 ms", False), ("5 ms", True)])
def test_a_loop_runs_where_every_delay_leaves_room_for_the_hold(load_boom, shortest, runs):
    override = f'uncertainty.delay_as_it_runs=["{shortest}", "14 ms"]'
    assert (
        LinearModel.of(load_boom(override, "objective.tracking_loop=continuous", corners=True)).runs
        == runs
    )


# Corners ----------------------------------------------------------------------------------------


def test_corners_are_light_and_heavy_with_all_lags_small_or_all_large(model):
    corners = model.plants.picked(model.corners())
    small, large = (0.011, 0.0001, 0.0001), (0.0215, 0.0122, 0.0119)
    expected = {(mass, *lags) for mass in (24500.0, 49000.0) for lags in (small, large)}
    assert set(zip(*corners[:4], strict=True)) == expected
    assert corners.number == 4


def test_ranges_without_width_leave_fewer_corners(load_boom):
    ranges = {"mass": "30 t", "delay": "12 ms", "tau_a": "5 ms", "tau_b": "6 ms"}
    ranges["delay_as_it_runs"] = "12 ms"
    fixed = [f'uncertainty.{key}=["{value}", "{value}"]' for key, value in ranges.items()]
    assert len(LinearModel.of(load_boom(fixed[0], corners=True)).corners()) == 2
    assert LinearModel.of(load_boom(*fixed, corners=True)).corners().tolist() == [0]


# Loops ------------------------------------------------------------------------------------------


def test_loops_are_those_of_the_box_with_the_inequalities_path(model):
    loops = model.loops(model.gains)
    assert loops.plants is model.plants
    assert (loops.gains, loops.path, loops.which) == (PUBLISHED, model.path, FORCE)


def test_a_studys_gains_and_packed_gains_give_the_same_loops(model):
    own = model.study.study.gains.model_copy(update={"k_p_vel": 4e5, "xi": 0.7})
    packed = PUBLISHED._replace(k_p_vel=4e5, xi=0.7)
    assert model.loops(own).gains == model.loops(packed).gains == packed
    omega = np.array([5.0, 60.0])
    np.testing.assert_array_equal(
        model.nominal_gains(omega, own), model.nominal_gains(omega, packed)
    )


def test_path_plants_and_place_may_be_given(model):
    one = model.plants.picked(np.array([7]))
    loops = model.loops(model.gains, model.filters, one, VELOCITY)
    assert loops.plants is one
    assert (loops.path, loops.which) == (model.filters, VELOCITY)


def test_as_it_runs_the_path_is_there_whatever_the_inequalities_leave_out(model):
    one = model.plants.picked(np.array([7]))
    loops = model.as_it_runs(model.gains, one)
    assert model.path == NO_PATH
    assert (loops.path, loops.which) == (model.filters, FORCE)
    assert loops.plants is one
    assert model.as_it_runs(model.gains).plants is model.explicit


def test_the_nominal_loop_is_eq_14_and_eq_22(model):
    velocity = model.nominal_loop(model.gains, which=VELOCITY)
    force = model.nominal_loop(model.gains)
    assert velocity.plants.number == force.plants.number == 1
    inner = nominal_by_hand(S)
    np.testing.assert_allclose(velocity.response(S, ROWS), inner, rtol=1e-12)
    expected = inner * (1 + position_controller(S) / S)
    np.testing.assert_allclose(force.response(S, ROWS), expected, rtol=1e-12)


def test_the_nominal_loop_may_have_a_path(model):
    bare = model.nominal_loop(model.gains, which=VELOCITY).response(S, ROWS)
    late = model.nominal_loop(model.gains, model.filters, VELOCITY).response(S, ROWS)
    assert np.all(np.angle(late / bare) < 0)
    assert np.all(np.abs(late) < np.abs(bare))


def test_nominal_gains_are_those_of_eq_18_and_eq_19(model):
    velocity, position = model.nominal_gains(S.imag, model.gains)
    inner = nominal_by_hand(S)
    np.testing.assert_allclose(velocity, inner, rtol=1e-12)
    outer = inner / (S * (1 + inner)) * position_controller(S)
    np.testing.assert_allclose(position, outer, rtol=1e-12)


# Places -----------------------------------------------------------------------------------------


def test_the_plant_at_a_plants_place_is_that_plant(model):
    for index in range(model.plants.number):
        at = model.point(index, 12.0)
        assert at.response is None
        assert at.frequency_rad_s == 12.0
        for found, column in zip(model.plant(at), model.plants, strict=True):
            assert found.tolist() == [column[index]]


def test_both_sides_are_those_of_the_box_or_of_the_plants_given(model):
    omega = np.array([3.0, 20.0, 90.0])
    whole = model.sides(omega, model.gains)
    assert whole.plant_ratio.shape == (2, 3**4)
    some = np.array([80, 4])
    part = model.sides(omega, model.gains, model.plants.picked(some))
    np.testing.assert_array_equal(part.plant_ratio, whole.plant_ratio[:, some])
    np.testing.assert_array_equal(part.right, whole.right)


# Measured members -------------------------------------------------------------------------------


def test_where_nothing_was_measured_the_whole_family_is_the_box(model):
    assert model.members is None
    assert model.member_names == ()
    assert model.whole_family is model.plants


def test_measured_members_stand_behind_the_box(measured):
    model = measured("beside")
    box, whole = model.plants, model.whole_family
    assert model.member_names == ("rig", "rig")
    assert whole.number == box.number + 2 == 16 + 2
    np.testing.assert_array_equal(whole.mass[:16], box.mass)
    assert whole.mass[16:].tolist() == [24500.0, 49000.0]
    for column in whole[1:]:  # neither delay nor lags nor areas of their own
        assert np.isfinite(column[:16]).all()
        assert np.isnan(column[16:]).all()


def test_the_place_of_a_member_names_its_response(measured):
    model = measured("beside")
    assert model.point(15, 1.0).response is None
    at = model.point(17, 8.0)
    assert (at.response, at.mass_kg, at.frequency_rad_s) == ("rig", 49000.0, 8.0)
    assert np.isnan(at.delay_s)


@pytest.mark.parametrize("place", ["beside", "instead"])
def test_both_sides_ask_the_measured_members(measured, place):
    model, omega = measured(place), np.array([0.5, 20.0])  # below the band, and within it
    found = model.sides(omega, model.gains)
    box = sides(omega, model.loops(model.gains), model.nominal)
    assert found.plant_ratio.shape == (2, 16 + 2)
    np.testing.assert_array_equal(found.left[:, 0], box.left[:, 0])
    assert np.all(found.left[:, 1] > box.left[:, 1])
    assert np.all(found.plant[:, 1] >= 16)


def test_the_box_is_a_studys_and_not_its_members(measured):
    model = measured("instead")
    for found, expected in zip(model.plants, plants_of(model.study), strict=True):
        np.testing.assert_array_equal(found, expected)
    assert model.loops(model.gains).plants.number == 16
