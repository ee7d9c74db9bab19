"""Requirements on the loop as it runs: met on one side of what is found, violated on the other."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.certify.result import Grounds
from mptune.errors import InputError
from mptune.robust.result import Status
from mptune.robust.sweep import sweep

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

SET = {"uncertainty": "section-5-1", "corners": True}
AT_LEAST = ("disk_margin", "phase_margin", "delay_margin")
FOUND = {  # of the published gains over §5.1's box; unit
    "disk_margin": (0.12205, ""),
    "phase_margin": (0.1425, "rad"),
    "delay_margin": (4.53e-3, "s"),
    "peak_compliance": (3.1709e-7, "m/N"),
    "overshoot": (0.4048, ""),
    "settling_time": (1.2885, "s"),
    "tracking_index": (14.39e-3, "s"),  # of the continuous loop
}
CERTIFIED = (*AT_LEAST, "peak_compliance")


def check_of(load_boom, name, limit, **options):
    value = f"{limit!r}" if not FOUND[name][1] else f'"{limit!r} {FOUND[name][1]}"'
    asked = f"requirements.{name}={value}", "objective.tracking_loop=continuous"
    result = sweep(load_boom(*asked, **options))
    (check,) = [check for check in result.checks if check.key == name]
    return check, result


@pytest.mark.parametrize("name", FOUND)
def test_a_limit_is_met_on_one_side_of_what_is_found_and_violated_on_the_other(load_boom, name):
    expected = FOUND[name][0]
    for factor in (0.98, 1.02):
        check, result = check_of(load_boom, name, factor * expected, **SET)
        met = (factor < 1) == (name in AT_LEAST)
        assert check.status is (Status.SATISFIED if met else Status.VIOLATED)
        assert check.found == pytest.approx(expected, rel=6e-3)
        assert result.satisfied == met
        assert check.grounds is (Grounds.CERTIFIED if name in CERTIFIED else Grounds.GRID)
        assert check.at.mass_kg in {24500.0, 49000.0}
        assert FOUND[name][1] in check.limit


def test_a_limit_between_attained_and_guaranteed_is_closed_in_upon(load_boom):
    """The bounds of the disk margin stand 0.1 % apart; the limit lies between them."""
    attained = 0.12204835
    check, _ = check_of(load_boom, "disk_margin", attained * (1 - 2e-4), **SET)
    assert check.status is Status.SATISFIED


@pytest.mark.parametrize("name", ["disk_margin", "delay_margin", "peak_compliance"])
def test_an_unstable_family_has_none(load_boom, name):
    limit = 'uncertainty.delay_as_it_runs=["11 ms", "21.5 ms"]', 'gains.k_p_vel="1100 kN s/m"'
    value = 0.01 if name == "disk_margin" else f'"1 {FOUND[name][1]}"'
    result = sweep(load_boom(*limit, f"requirements.{name}={value}", corners=True))
    (check,) = [check for check in result.checks if check.key == name]
    assert check.status is Status.UNSTABLE
    assert np.isnan(check.found)
    assert check.at is not None


def test_without_room_for_the_hold_nothing_is_evaluated(load_boom):
    asked = (
        'uncertainty.delay_as_it_runs=["3 ms", "14 ms"]',
        "requirements.disk_margin=0.1",
        "objective.tracking_loop=continuous",
    )
    result = sweep(load_boom(*asked, corners=True))
    (check,) = [check for check in result.checks if check.key == "disk_margin"]
    assert check.status is Status.NOT_EVALUATED
    assert not result.satisfied


def test_feedforward_counts_for_tracking_alone(load_boom):
    asked = ('objective.tracking_loop="sampled"', 'requirements.tracking_index="20 ms"')
    study = load_boom(*asked, **SET)
    ahead = study.study.feedforward.model_copy(
        update={"acceleration_mass": 37e3, "reference_lag": 0.012}
    )
    for given, met in ((None, False), (ahead, True)):
        (check,) = [
            check
            for check in sweep(study, feedforward=given).checks
            if check.key == "tracking_index"
        ]
        assert (check.status is Status.SATISFIED) == met


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("requirements.disk_margin=2.5", "2"),
        ('requirements.phase_margin="200 deg"', "3.14"),
        ('requirements.peak_compliance="1 mm"', "dimension"),
    ],
)
def test_limits_that_no_loop_can_have_are_refused(load_boom, text, rule):
    with pytest.raises(InputError, match=rule):
        load_boom(text)
