"""What follows a slider agrees with the sweep that comes after it."""

import numpy as np
import pytest

from mptune.explore.curves import step_view
from mptune.explore.looking import CHOSEN, corner_model, looked_at
from mptune.explore.move import simulated_move
from mptune.explore.picture import picture
from mptune.explore.setting import PLANTS, HandSetting
from mptune.explore.words import lamps
from mptune.loops.broken import FORCE
from mptune.robust.result import Status


@pytest.fixture(scope="module")
def shown(load_boom):
    return picture(load_boom(), HandSetting(path="with"))


def test_both_inequalities_are_the_sweep_s(shown, fig_5):
    for loop, condition in enumerate(fig_5.conditions):
        ratio, at = shown.sides.worst(loop)
        assert ratio == pytest.approx(condition.worst_ratio, rel=2e-4)
        assert ratio <= condition.worst_ratio * (1 + 1e-9)
        assert (at.mass_kg, at.delay_s) == (condition.at.mass_kg, condition.at.delay_s)
        again = fig_5.model.sides(shown.sides.omega, fig_5.model.gains)
        assert shown.sides.found.left[loop] == pytest.approx(again.left[loop])
        assert shown.sides.found.right[loop] == pytest.approx(again.right[loop])


def test_lamps_are_the_sweep_s_checks(shown, fig_5):
    found = {check.key: check for check in shown.checks}
    for check in fig_5.checks:
        assert found[check.key].status == check.status
        assert found[check.key].found == pytest.approx(check.found, rel=2e-4)
    assert found["unstable_corners_as_it_runs"].status is Status.SATISFIED


def test_lamps_go_out_where_gains_are_too_high(load_boom):
    study = load_boom(corners=True)
    high = HandSetting().turn("gains.k_p_vel", 1.4e6, study)
    found = {check.key: check.status for check in picture(study, high).checks}
    assert found["velocity_ratio"] is Status.VIOLATED
    assert found["unstable_corners_as_it_runs"] is Status.UNSTABLE


def test_the_corners_chain_is_near_the_family_s(shown, fig_5):
    """On the boom the corners hold the worst plants; the corners' factor errs on the high side."""
    links = {link.name: link.factor for link in shown.chain()}
    names = {"none": "true family", "filters": "with measurement path", "sampled": "sampled"}
    for path, name in names.items():
        factor, _ = fig_5.family(path).worst("gain_margin", FORCE)
        assert factor * (1 - 1e-6) <= links[name] <= 1.01 * factor
    factor, model = links["Eq. 17 and 21"], fig_5.model
    for scale, holds in ((0.99, True), (1.01, False)):
        gains = model.gains._replace(k_p_vel=scale * factor * model.gains.k_p_vel)
        assert (model.sides(shown.sides.omega, gains).ratio.max() < 1) == holds


def test_requirements_on_margins_are_asked_of_the_corners(load_boom):
    study = load_boom("requirements.sampled_sensitivity_peak=9", corners=True)
    found = picture(study, HandSetting())
    check = next(one for one in found.checks if one.key == "sampled_sensitivity_peak")
    assert check.status is Status.SATISFIED
    assert 1 < check.found < 9


@pytest.mark.parametrize("plant", PLANTS)
def test_every_plant_can_be_looked_at(shown, plant):
    for with_path in (False, True):
        looked = looked_at(shown.sides, shown.corners, plant, with_path=with_path)
        mass, delay = looked.plants.mass[CHOSEN], looked.plants.delay[CHOSEN]
        heavy, slow = "heaviest" in plant, "slowest" in plant or "worst" in plant
        assert mass == (49e3 if heavy else 24.5e3)
        slowest, fastest = (0.014, 0.010) if with_path else (0.0215, 0.011)
        assert delay == (slowest if slow else fastest)


def test_sensitivities_and_steps_belong_to_the_loops(shown, fig_5):
    loops = shown.loops
    assert loops.sensitivity == pytest.approx(abs(1 / (1 + loops.gain)))
    family = fig_5.family("filters")
    row = family.plants.delay == shown.looked.plants.delay[CHOSEN]
    row &= family.plants.mass == shown.looked.plants.mass[CHOSEN]
    row &= family.plants.tau_a == shown.looked.plants.tau_a[CHOSEN]
    row &= family.plants.tau_b == shown.looked.plants.tau_b[CHOSEN]
    peak = family.margins.sensitivity_peak[FORCE][row][0]
    assert loops.sensitivity[CHOSEN].max() == pytest.approx(peak, rel=0.01)
    steps = shown.steps
    assert steps.velocity.value[:, -1] == pytest.approx(1, abs=0.03)
    assert abs(steps.load.value[:, -1]).max() < abs(steps.load.value).max()


def test_beside_a_state_estimator_steps_are_those_without_path(load_boom):
    study = load_boom('estimator.kind="state"', corners=True)
    found = picture(study, HandSetting(path="with"))
    assert not found.steps.along
    plain = looked_at(found.sides, found.corners, PLANTS[0], with_path=False)
    bare = step_view(found.sides.model.gains, plain)
    assert bare.position.value.shape == found.steps.position.value.shape
    assert corner_model(found.sides.model).plants.number == 8


def test_a_move_is_one_of_the_machine(load_boom):
    study = load_boom(corners=True)
    move = simulated_move(study, 24500.0)
    assert move.time[-1] == pytest.approx(2.25, abs=0.01)
    assert 0.1e-3 < np.abs(move.error).max() < 3e-3
    assert len(move.states) == 2
    assert all(np.all((one >= 0) & (one < 28)) for one in move.states)
    assert move.words == simulated_move(study, 24500.0).words


def test_lamps_say_what_they_rest_on(shown, fig_5):
    quick, sure = lamps(shown.checks), lamps(shown.checks, fig_5.checks, shown.checks)
    assert 'data-key="velocity_ratio" data-grounds="grid" data-status="satisfied"' in quick
    assert 'data-key="velocity_ratio" data-grounds="proved" data-status="satisfied"' in sure
    assert "A: 0.6411" in sure
