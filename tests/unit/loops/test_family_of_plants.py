"""The family of plants, and what may be counted on it."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.loops.broken import FORCE, POSITION, VELOCITY
from mptune.loops.family import FamilyLoops, nominal_plants, plants_of
from mptune.loops.velocity import nominal_velocity, true_velocity
from mptune.params.pack import NO_PATH, LoopGains, NominalPlant, Plants

GAINS = LoopGains(700e3, 13.0, 22.0, 42.0, 0.55, 0.006)
ONE = Plants(*(np.array([value]) for value in (24500.0, 0.011, 0.01, 0.01)))


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
    plants = nominal_plants(NominalPlant(24500.0, 0.011))
    mass, delay, tau_a, tau_b = (float(column[0]) for column in plants)
    found = true_velocity(40j, mass, delay, tau_a, tau_b, 0.5)
    assert found == pytest.approx(nominal_velocity(40j, 24500.0, 0.011), rel=1e-15)


def test_poles_of_the_position_loop_are_not_counted_where_its_inner_loop_may_hide_some():
    with pytest.raises(ValueError, match="FORCE"):
        FamilyLoops(POSITION, ONE, 0.57, GAINS, NO_PATH)


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
    loops = FamilyLoops(which, ONE, 0.57, GAINS._replace(**changes), NO_PATH)
    assert loops.integrators == integrators
    s = np.array([1e-7j])
    leading = loops.leading / s**integrators
    np.testing.assert_allclose(loops.response(s, np.array([0])), leading, rtol=1e-5)


@pytest.mark.parametrize("which", [VELOCITY, FORCE])
def test_beyond_its_tail_a_loop_is_at_most_one_half_in_the_right_half_plane(which):
    loops = FamilyLoops(which, ONE, 0.57, GAINS, NO_PATH)
    size = loops.tail[0] * np.geomspace(1, 100, 40)
    angle = np.linspace(-np.pi / 2, np.pi / 2, 41)[:, None]
    s = (size * np.exp(1j * angle)).ravel()
    assert np.all(np.abs(loops.response(s, np.zeros(len(s), np.int64))) <= 0.5)
