"""The family of plants, and what may be counted on it."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.loops.broken import FORCE, POSITION, VELOCITY
from mptune.loops.family import FamilyLoops, nominal_plants, plants_of
from mptune.loops.velocity import nominal_velocity, plant_at, true_velocity
from mptune.params.packed import NO_PATH, LoopGains, NominalPlant, Plants

GAINS = LoopGains(700e3, 13.0, 22.0, 42.0, 0.55, 0.006)
ONE = Plants(*(np.array([value]) for value in (24500.0, 0.011, 0.01, 0.01, 0.57)))


def test_the_grid_holds_every_combination_once(load_boom):
    plants = plants_of(load_boom("uncertainty.points=3"))
    rows = set(zip(*plants, strict=True))
    assert len(rows) == 3**4 == len(plants.mass)


def test_a_range_without_width_is_one_point_of_the_grid(load_boom):
    overrides = ['uncertainty.mass=["30 t", "30 t"]', 'uncertainty.tau_a=["0 s", "0 s"]']
    plants = plants_of(load_boom("uncertainty.points=3", *overrides))
    assert len(plants.mass) == 9
    assert set(plants.mass) == {30e3}


def test_a_nominal_plant_is_a_true_plant_without_lags():
    nominal = NominalPlant(24500.0, 0.011)
    found = true_velocity(40j, plant_at(nominal_plants(nominal), 0))
    assert found == pytest.approx(nominal_velocity(40j, nominal), rel=1e-15)


def test_poles_of_the_position_loop_are_not_counted_where_its_inner_loop_may_hide_some():
    with pytest.raises(ValueError, match="FORCE"):
        FamilyLoops(ONE, GAINS, NO_PATH, POSITION)


@pytest.mark.parametrize(
    ("which", "changes", "integrators"),
    [
        (VELOCITY, {}, 1),
        (FORCE, {}, 3),
        (FORCE, {"k_p_pos": 0.0}, 3),
        (FORCE, {"k_i_pos": 0.0}, 2),
        (FORCE, {"k_i_pos": 0.0, "k_p_pos": 0.0}, 1),
    ],
)
def test_the_loop_approaches_its_leading_term_at_the_origin(which, changes, integrators):
    loops = FamilyLoops(ONE, GAINS._replace(**changes), NO_PATH, which)
    assert loops.integrators == integrators
    s = np.array([1e-7j])
    leading = loops.leading / s**integrators
    np.testing.assert_allclose(loops.response(s, np.array([0])), leading, rtol=1e-5)


@pytest.mark.parametrize("which", [VELOCITY, FORCE])
def test_beyond_its_tail_a_loop_is_at_most_one_half_in_the_right_half_plane(which):
    loops = FamilyLoops(ONE, GAINS, NO_PATH, which)
    size = loops.tail[0] * np.geomspace(1, 100, 40)
    angle = np.linspace(-np.pi / 2, np.pi / 2, 41)[:, None]
    s = (size * np.exp(1j * angle)).ravel()
    assert np.all(np.abs(loops.response(s, np.zeros(len(s), np.int64))) <= 0.5)


def test_scaled_loops_are_the_loops_times_the_factor():
    loops = FamilyLoops(ONE, GAINS, NO_PATH)
    s, rows = np.array([3.0j, 40j]), np.zeros(2, np.int64)
    found = loops.scaled(1.7).response(s, rows)
    np.testing.assert_allclose(found, 1.7 * loops.response(s, rows), rtol=1e-14)


def test_picked_loops_are_those_of_the_picked_plants():
    plants = ONE.followed_by(ONE._replace(mass=2 * ONE.mass)).followed_by(ONE)
    loops, s = FamilyLoops(plants, GAINS, NO_PATH, VELOCITY), np.array([40j])
    for rows in (np.array([1]), np.array([False, True, False])):
        found = loops.picked(rows)
        assert (found.which, found.gains, found.path) == (VELOCITY, GAINS, NO_PATH)
        assert found.plants.number == 1
        np.testing.assert_array_equal(
            found.response(s, np.array([0])), loops.response(s, np.array([1]))
        )


def test_loops_broken_elsewhere_are_the_same_loops():
    loops = FamilyLoops(ONE, GAINS, NO_PATH)
    assert loops.which == FORCE
    inner = loops.broken_at(VELOCITY)
    assert (inner.which, inner.plants, inner.gains) == (VELOCITY, ONE, GAINS)
    with pytest.raises(ValueError, match="FORCE"):
        loops.broken_at(POSITION)
