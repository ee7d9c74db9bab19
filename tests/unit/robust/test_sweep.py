"""The sweep: converged worst ratios, premises, and statuses."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.robust.model import LinearModel
from mptune.robust.result import Status
from mptune.robust.sweep import sweep

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes


@pytest.mark.parametrize("swept", ["fig_5", "section_5_1"])
def test_a_grid_ten_times_denser_finds_no_higher_ratio(request, swept):
    result = request.getfixturevalue(swept)
    dense = np.geomspace(result.omega[0], result.omega[-1], 10 * len(result.omega))
    found = result.model.sides(dense, result.gains)
    for loop, condition in enumerate(result.conditions):
        highest = found.ratio[loop].max()
        print(f"{swept} {condition.name}: {condition.worst_ratio:.8f}, dense grid {highest:.8f}")
        assert highest <= condition.worst_ratio * (1 + 1e-4)


def test_frequencies_rise_and_curves_belong_to_them(fig_5):
    assert np.all(np.diff(fig_5.omega) > 0)
    pick = np.arange(0, len(fig_5.omega), 37)
    found = fig_5.model.sides(fig_5.omega[pick], fig_5.gains)
    for loop, condition in enumerate(fig_5.conditions):
        np.testing.assert_array_equal(condition.left[pick], found.left[loop])
        np.testing.assert_allclose(condition.right[pick], found.right[loop], rtol=1e-13)
        np.testing.assert_array_equal(condition.plant[pick], found.plant[loop])


def test_the_plant_behind_the_worst_ratio_gives_that_ratio(fig_5):
    for loop, condition in enumerate(fig_5.conditions):
        at, model = condition.at, fig_5.model
        found = model.sides(np.array([at.frequency_rad_s]), fig_5.gains, model.plant(at))
        assert found.ratio[loop, 0] == pytest.approx(condition.worst_ratio, rel=1e-12)


def test_other_gains_may_be_swept_than_the_study_s_own(load_boom):
    study = load_boom(corners=True)
    gains = study.study.gains.model_copy(update={"k_p_vel": 400e3})
    result = sweep(study, gains)
    assert result.gains.k_p_vel == 400e3
    assert result.velocity.worst_ratio < sweep(study).velocity.worst_ratio


def test_a_slow_loop_meets_the_low_frequency_limit_and_says_so(load_boom):
    result = sweep(load_boom("gains.k_p_vel=100 kN s/m", corners=True))
    assert result.velocity.low_frequency_limit
    assert result.velocity.worst_ratio == pytest.approx(0.5, rel=1e-4)


def test_a_requirement_below_the_low_frequency_limit_is_violated_at_any_gain(load_boom):
    for gain in ("10 kN s/m", "300 kN s/m"):
        overrides = [f"gains.k_p_vel={gain}", "requirements.velocity_ratio=0.49"]
        assert sweep(load_boom(*overrides, corners=True)).velocity.status is Status.VIOLATED


def test_a_ratio_above_its_requirement_is_violated(load_boom):
    result = sweep(load_boom("requirements.velocity_ratio=0.6", corners=True))
    assert result.velocity.status is Status.VIOLATED
    assert not result.velocity.satisfied
    assert not result.satisfied
    assert result.position.satisfied


def test_an_unstable_nominal_loop_satisfies_nothing(load_boom):
    result = sweep(load_boom("gains.k_p_vel=4000 kN s/m", corners=True))
    assert result.velocity.status is Status.UNSTABLE
    assert result.position.status is Status.UNSTABLE
    assert not result.velocity.nominal_stable
    assert not result.satisfied


def test_an_unstable_true_velocity_loop_breaks_the_premise_of_eq_21(load_boom):
    result = sweep(load_boom("gains.k_p_vel=2500 kN s/m", corners=True))
    assert result.velocity.nominal_stable
    assert not result.family("none").velocity_stable.all()
    assert not result.position.poles_equal
    assert result.position.status is Status.UNSTABLE


def test_a_position_controller_without_gain_has_no_error_to_bound(load_boom):
    # L_p = 0: the right-hand side of Eq. 21 is infinite, the ratio zero and the margin endless
    result = sweep(load_boom("gains.k_p_pos=0 1/s", "gains.k_i_pos=0 1/s^2", corners=True))
    assert result.position.worst_ratio == 0
    assert result.position.margin == np.inf
    assert result.velocity.worst_ratio == pytest.approx(0.641, abs=0.001)
    assert len(result.omega) < 3000  # a level curve is not refined everywhere


def test_a_family_of_the_nominal_plant_alone_has_endless_margins(load_boom):
    ranges = {"mass": "24500 kg", "delay": "11 ms", "tau_a": "0 s", "tau_b": "0 s"}
    overrides = [f'uncertainty.{key}=["{value}", "{value}"]' for key, value in ranges.items()]
    result = sweep(load_boom(*overrides))
    for condition in result.conditions:
        assert condition.worst_ratio == 0
        assert condition.margin == np.inf


def test_a_condition_that_holds_proves_every_plant_stable(load_boom):
    for gain in (200, 700, 1000):
        result = sweep(load_boom(f"gains.k_p_vel={gain} kN s/m", corners=True))
        if all(condition.worst_ratio < 1 for condition in result.conditions):
            assert result.family("none").stable.all()


def test_a_requirement_curve_is_interpolated_over_the_logarithm_of_frequency(load_boom):
    curve = '[["10 rad/s", 0.8], ["1000 rad/s", 0.4]]'
    study = load_boom(f"requirements.velocity_ratio={curve}", corners=True)
    condition, omega = sweep(study).velocity, sweep(study).omega
    below, above = omega <= 10, omega >= 1000
    assert np.all(condition.allowed[below] == 0.8)
    assert np.all(condition.allowed[above] == 0.4)
    between = ~below & ~above
    expected = 0.8 - 0.2 * np.log10(omega[between] / 10)
    np.testing.assert_allclose(condition.allowed[between], expected, rtol=1e-12)


def test_a_requirement_curve_is_used_where_it_is_tightest_and_not_where_the_ratio_is_highest(
    load_boom,
):
    curve = '[["99 rad/s", 0.9], ["100 rad/s", 0.3]]'
    condition = sweep(load_boom(f"requirements.velocity_ratio={curve}", corners=True)).velocity
    assert condition.status is Status.VIOLATED
    on_grid = (condition.ratio / condition.allowed).max()
    assert on_grid <= condition.worst_use <= 1.01 * on_grid
    assert condition.worst_use_at.frequency_rad_s == pytest.approx(100, rel=0.02)
    assert condition.at.frequency_rad_s == pytest.approx(55.3, rel=0.01)


def test_a_kink_of_a_requirement_curve_is_refined_as_well(load_boom):
    curve = '[["99 rad/s", 0.9], ["100 rad/s", 0.3]]'
    study = load_boom(f"requirements.velocity_ratio={curve}", corners=True)
    result = sweep(study)
    at_kink = LinearModel.of(study).sides(np.array([100.0]), result.gains)
    assert at_kink.ratio[0, 0] / 0.3 <= result.velocity.worst_use * (1 + 1e-4)


def test_every_requirement_of_the_study_is_answered(load_boom):
    wanted = {
        "sensitivity_peak": "2",
        "complementary_peak": "2",
        "gain_margin": "1.5",
        "noise_gain": "1e7 N/m",
    }
    overrides = [f"requirements.{key}={value}" for key, value in wanted.items()]
    result = sweep(load_boom(*overrides, corners=True))
    names = " ".join(check.key for check in result.checks)
    for key in (*wanted, "velocity_ratio", "position_ratio"):
        assert key in names


def test_a_peak_requirement_is_held_against_the_family(load_boom):
    for limit, status in (("5.0", Status.SATISFIED), ("4.5", Status.VIOLATED)):
        result = sweep(load_boom(f"requirements.sensitivity_peak={limit}", corners=True))
        (check,) = [check for check in result.checks if check.key == "sensitivity_peak"]
        assert round(check.found, 2) == 4.81
        assert check.status is status


def test_with_the_path_in_the_model_the_unstable_family_fails_its_check(load_boom):
    result = sweep(load_boom("model.measurement_path=filters", corners=True, twice=True))
    assert not result.satisfied
    assert any(check.status is Status.UNSTABLE for check in result.checks)


def test_margins_of_an_unstable_plant_are_not_given(fig_5_twice):
    family = fig_5_twice.family("filters")
    at_force = family.margins.sensitivity_peak[2]
    assert np.all(np.isnan(at_force[~family.stable]))
    assert np.all(np.isfinite(at_force[family.stable]))
