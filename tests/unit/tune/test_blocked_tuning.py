"""What the tuner says of the paper's study when nothing can be met, and what stands in the way."""

import numpy as np
import pytest

from mptune.tune.result import TuneStatus
from mptune.tune.tuner import Tuner, tune

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes


@pytest.mark.parametrize("limit", [0.45, 0.49])
def test_velocity_ratio_below_the_low_frequency_limit_is_infeasible(load_boom, limit):
    """As ω → 0 the ratio tends to 1 − m_min/m_max = 0.5 at any gain."""
    found = tune(load_boom(f"requirements.velocity_ratio={limit}", corners=True))
    assert found.status is TuneStatus.INFEASIBLE
    assert found.blocking.requirement == "velocity_ratio"
    assert found.blocking.least_found == pytest.approx(0.5)
    assert found.blocking.at.mass_kg == 49000
    assert found.blocking.at.frequency_rad_s == 0
    assert "nominal.mass" in found.blocking.remedy


def test_unreachable_position_ratio_names_plant_frequency_and_how_far_it_is(load_boom):
    found = tune(load_boom("requirements.position_ratio=0.1", corners=True))
    assert found.status is TuneStatus.INFEASIBLE
    assert found.blocking.requirement == "position_ratio"
    assert found.blocking.at.mass_kg in {24500, 49000}
    assert 1 < found.blocking.at.frequency_rad_s < 200
    reliefs = {one.requirement: one.factor for one in found.blocking.reliefs}
    print(found.blocking.remedy, reliefs)
    needed = 0.1 * reliefs["position_ratio"]
    assert needed == pytest.approx(found.sweep.position.worst_ratio, rel=2e-3)
    given = tune(load_boom(f"requirements.position_ratio={1.005 * needed}", corners=True))
    assert given.sweep.satisfied


def test_two_requirements_in_each_others_way_say_how_far_each_would_have_to_give(load_boom):
    asked = ('requirements.noise_gain="20 MN/m"', "requirements.position_ratio=0.3")
    found = tune(load_boom(*asked, corners=True))
    assert found.status is TuneStatus.INFEASIBLE
    reliefs = {one.requirement: one.factor for one in found.blocking.reliefs}
    print(found.blocking.requirement, reliefs)
    assert set(reliefs) == {"position_ratio", "noise_gain"}
    factor = reliefs["position_ratio"]
    assert np.isfinite(factor)
    assert factor > 1
    assert found.blocking.least_found < factor  # both give a little at the nearest gains


def test_a_bound_above_every_admissible_velocity_gain_blocks(load_boom):
    bound = 'requirements.bounds.k_p_vel=["900 kN s/m", "950 kN s/m"]'
    found = tune(load_boom(bound, corners=True))
    assert found.status is TuneStatus.INFEASIBLE
    assert found.blocking.requirement == "velocity_ratio"
    assert "below the study's bound" in found.blocking.remedy


def test_a_sampled_loop_that_cannot_be_asked_is_not_taken_as_met(load_boom):
    asked = ("requirements.gain_margin=1.5", 'uncertainty.delay_as_it_runs=["3 ms", "14 ms"]')
    found = tune(load_boom(*asked, corners=True))
    assert not found.sweep.satisfied
    assert found.blocking.requirement == "gain_margin"
    assert "half a sampling period" in found.blocking.remedy


def test_a_tuner_says_whether_the_velocity_gain_blocks(load_boom):
    assert Tuner(load_boom("requirements.velocity_ratio=0.45", corners=True)).blocked
    assert not Tuner(load_boom(corners=True)).blocked
