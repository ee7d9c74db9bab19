"""Eq. 17 and Eq. 21 with the published gains, over the paper's two sets of ranges."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.params.packed import Plants
from mptune.robust.model import LinearModel
from mptune.robust.result import Status

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

WORST = [
    # sweep, loop, worst ratio, mass, delay, frequency
    ("fig_5", "velocity", 0.641, 24500, 0.0215, 55.2),
    ("fig_5", "position", 0.476, 24500, 0.0215, 38.8),
    ("section_5_1", "velocity", 0.509, 49000, 0.014, 24.7),
    ("section_5_1", "position", 0.376, 49000, 0.014, 15.5),
]


@pytest.mark.parametrize(("swept", "loop", "ratio", "mass", "delay", "frequency"), WORST)
def test_the_worst_ratio_and_where_it_is(request, swept, loop, ratio, mass, delay, frequency):
    condition = getattr(request.getfixturevalue(swept), loop)
    at = condition.at
    print(f"{swept} {loop}: {condition.worst_ratio:.4f} at {at}")
    assert round(condition.worst_ratio, 3) == ratio
    assert at.mass_kg == mass
    assert at.delay_s == delay
    assert (at.tau_a_s, at.tau_b_s) == (0.0122, 0.0119)
    assert at.frequency_rad_s == pytest.approx(frequency, rel=0.01)


@pytest.mark.parametrize("swept", ["fig_5", "section_5_1"])
def test_the_published_gains_satisfy_both_conditions(request, swept):
    result = request.getfixturevalue(swept)
    for condition in result.conditions:
        assert condition.worst_ratio < 1
        assert condition.nominal_stable
        assert condition.poles_equal


def test_the_published_gains_meet_the_requirements_of_their_study(fig_5):
    assert [condition.status for condition in fig_5.conditions] == [Status.SATISFIED] * 2
    assert fig_5.satisfied


@pytest.mark.parametrize("loop", ["velocity", "position"])
def test_the_worst_ratio_is_the_largest_over_plants_and_over_frequencies(fig_5, loop):
    condition = getattr(fig_5, loop)
    assert condition.ratio.max() == pytest.approx(condition.plant_ratio.max(), rel=1e-12)
    assert condition.worst_ratio == pytest.approx(condition.ratio.max(), rel=1e-6)
    assert condition.worst_ratio >= condition.ratio.max() * (1 - 1e-12)  # polished off the grid
    assert condition.margin == 1 / condition.worst_ratio


def at_low_frequency(study):
    model = LinearModel.of(study)
    return model.sides(np.array([1e-5, 1e-4]), model.gains)


def test_the_ratio_of_eq_17_begins_at_one_half_whatever_the_gain(load_boom):
    for gain in ("100 kN s/m", "700 kN s/m"):
        found = at_low_frequency(load_boom(f"gains.k_p_vel={gain}", corners=True))
        assert found.ratio[0] == pytest.approx(0.5, abs=1e-5)


def test_the_low_frequency_limit_follows_the_nominal_mass(load_boom):
    # |m_nominal/m − 1| is largest at the least mass: 36.75/24.5 − 1, again one half,
    # and for 32.667 t it is 1/3 at either end.
    found = at_low_frequency(load_boom("uncertainty.nominal.mass=32666.666666667 kg", corners=True))
    assert found.ratio[0] == pytest.approx(1 / 3, abs=1e-5)


def test_the_ratio_of_eq_21_vanishes_at_low_frequency(load_boom):
    found = at_low_frequency(load_boom(corners=True))
    assert np.all(found.ratio[1] < 1e-4)


def test_the_error_of_eq_17_depends_on_no_gain_and_that_of_eq_21_on_the_velocity_gain(boom):
    omega, model = np.geomspace(1, 300, 20), LinearModel.of(boom)
    columns = ([3e4, 49e3], [0.012, 0.02], [0.01] * 2, [0.0] * 2, [0.57] * 2)
    plants = Plants(*(np.array(column) for column in columns))
    published = model.gains
    position = published._replace(k_p_pos=5.0, k_i_pos=50.0, omega=60.0, xi=0.9, tau=0.01)
    velocity = published._replace(k_p_vel=300e3)
    left = [model.sides(omega, gains, plants).left for gains in (published, position, velocity)]
    np.testing.assert_array_equal(left[0], left[1])
    np.testing.assert_array_equal(left[0][0], left[2][0])
    assert not np.allclose(left[0][1], left[2][1])
