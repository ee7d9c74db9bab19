"""Drivers of the worst case: against the sweep itself, and against Eq. 17 by hand."""

import numpy as np
import pytest

from mptune.loops.velocity import nominal_velocity, true_velocity
from mptune.params.packed import Plant
from mptune.robust.one_at_a_time import PARAMETERS, one_at_a_time
from mptune.robust.sweep import sweep

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes


@pytest.fixture(scope="module")
def swept(load_boom):
    return sweep(load_boom(corners=True))


def test_each_condition_has_every_parameter_strongest_first(swept):
    found = one_at_a_time(swept)
    for condition in swept.conditions:
        mine = [one for one in found if one.condition == condition.name]
        assert {one.parameter for one in mine} == {name for name, *_ in PARAMETERS}
        reaches = [one.reach for one in mine]
        assert reaches == sorted(reaches, reverse=True)
        assert reaches[0] > 0


def test_the_worst_plant_s_own_end_gives_the_worst_ratio_and_no_end_a_higher_one(swept):
    for one in one_at_a_time(swept):
        worst = getattr(swept, one.condition).worst_ratio
        # Asked at the sweep's own frequencies, while the worst ratio is polished.
        assert max(one.ratios) == pytest.approx(worst, rel=1e-6)
        assert one.worst in one.ends


def test_velocity_ratios_against_eq_17_by_hand(swept):
    at, gain = swept.velocity.at, swept.gains.k_p_vel
    share_a = swept.study.study.share_a
    worst = Plant(at.mass_kg, at.delay_s, at.tau_a_s, at.tau_b_s, share_a)
    points = 1j * swept.omega
    nominal = np.array([nominal_velocity(s, swept.model.nominal) for s in points])
    right = np.abs((1 + nominal * gain) / (nominal * gain))
    for one in one_at_a_time(swept):
        if one.condition != "velocity":
            continue
        for end, ratio in zip(one.ends, one.ratios, strict=True):
            plant = worst._replace(**{one.parameter: end})
            true = np.array([true_velocity(s, plant) for s in points])
            left = np.abs((true - nominal) / nominal)  # Eq. 16
            assert ratio == pytest.approx(float((left / right).max()), rel=1e-9)
