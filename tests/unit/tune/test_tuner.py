"""The first tuner: the largest velocity gain, and a position controller within Eq. 21."""

import pytest

from mptune.loops.family import plants_of
from mptune.params.pack import pack_gains, pack_nominal, pack_path
from mptune.robust.sweep import sweep
from mptune.tune.tuner import TuneStatus, tune
from mptune.tune.velocity import largest_velocity_gain

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

LIMIT = 0.65


@pytest.fixture(scope="module")
def tuned(load_boom):
    return tune(load_boom(corners=True))


def velocity_gain(study, limit=LIMIT, **options):
    return largest_velocity_gain(
        plants_of(study),
        pack_nominal(study),
        study.study.cylinder.share_a,
        pack_gains(study.study.gains),
        pack_path(study),
        limit,
        **options,
    )


@pytest.mark.parametrize("path", ["none", "filters"])
def test_velocity_gain_is_the_largest_that_meets_the_requirement(load_boom, path):
    study = load_boom(f'model.measurement_path="{path}"', corners=True)
    found = velocity_gain(study).k_p_vel
    ratios = [
        sweep(study, study.study.gains.model_copy(update={"k_p_vel": factor * found}))
        for factor in (0.99, 1.0, 1.01)
    ]
    values = [result.velocity.worst_ratio for result in ratios]
    print(f"path {path}: K_P,vel {found / 1e3:.1f} kN s/m, ratios {values}")
    assert values[0] < values[1] <= LIMIT < values[2]


def test_published_velocity_gain_is_found_from_its_own_ratio(load_boom, fig_5):
    found = velocity_gain(load_boom(), fig_5.velocity.worst_ratio)
    assert found.k_p_vel == pytest.approx(7e5, rel=1e-3)
    assert found.limited_by == "velocity_ratio"


def test_bound_limits_the_velocity_gain(load_boom):
    found = velocity_gain(load_boom(corners=True), upper=5e5)
    assert (found.k_p_vel, found.limited_by) == (5e5, "bounds")


def test_tuned_gains_meet_the_requirements_and_track_better(tuned):
    assert tuned.status is TuneStatus.FEASIBLE
    assert tuned.sweep.satisfied
    assert tuned.sweep.velocity.worst_ratio <= 0.65
    assert tuned.sweep.position.worst_ratio <= 0.48
    gain = 1 - tuned.figures.tracking / tuned.figures_before.tracking
    print(
        f"index {1e3 * tuned.figures_before.tracking:.2f} -> {1e3 * tuned.figures.tracking:.2f} ms"
        f" ({100 * gain:.0f} %), {tuned.evaluations} candidates"
    )
    assert gain > 0.15


def test_tuned_gains_stay_within_the_studys_bounds(tuned):
    assert 22 <= tuned.gains.k_i_pos <= 200
    assert 0.005 <= tuned.gains.tau <= 0.03


def test_the_same_study_gives_the_same_gains(load_boom, tuned):
    assert tune(load_boom(corners=True)).gains == tuned.gains


def test_disturbance_objective_raises_the_integral_gain(load_boom):
    study = load_boom(
        'objective.kind="disturbance"',
        'requirements.bounds.tau=["6 ms", "6.001 ms"]',
        "requirements.position_ratio=0.476",
        corners=True,
    )
    found = tune(study)
    print(f"K_I,pos 22 -> {found.gains.k_i_pos:.1f} 1/s²")
    assert found.sweep.satisfied
    assert found.gains.k_i_pos > 2.5 * 22


def test_velocity_ratio_below_the_low_frequency_limit_is_infeasible(load_boom):
    """As ω → 0 the ratio tends to 1 − m_min/m_max = 0.5 at any gain."""
    found = tune(load_boom("requirements.velocity_ratio=0.45", corners=True))
    assert found.status is TuneStatus.INFEASIBLE
    assert found.blocking is not None
    assert found.blocking.requirement == "velocity_ratio"
    assert found.blocking.least_found == pytest.approx(0.5)
    assert found.blocking.at.mass_kg == 49000
    assert found.blocking.at.frequency_rad_s == 0


def test_nominal_mass_inside_the_range_makes_it_feasible(load_boom):
    """The nominal mass is a choice: between the extremes the low-frequency limit falls."""
    found = velocity_gain(
        load_boom('uncertainty.nominal.mass="32667 kg"', corners=True), limit=0.45
    )
    assert found.k_p_vel > 1e5


def test_unreachable_position_ratio_is_infeasible_and_names_plant_and_frequency(load_boom):
    found = tune(load_boom("requirements.position_ratio=0.1", corners=True))
    assert found.status is TuneStatus.INFEASIBLE
    assert found.blocking is not None
    assert found.blocking.requirement.startswith("position_ratio")
    assert found.blocking.least_found > 0.1
    assert found.blocking.at.frequency_rad_s > 0


def test_a_requirement_that_cannot_be_checked_is_not_taken_as_met(load_boom):
    found = tune(load_boom('requirements.noise_gain="1 MN/m"', corners=True))
    assert not found.sweep.satisfied
    assert found.blocking is not None
    assert found.blocking.requirement == "noise_gain"
