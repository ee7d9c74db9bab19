"""What a sweep says to other programs."""

from __future__ import annotations

import json
import math

import pytest

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

AT = {"mass_kg", "delay_s", "tau_a_s", "tau_b_s", "frequency_rad_s"}
CONDITION = {"worst_ratio", "margin", "satisfied", "nominal_stable", "at"}


@pytest.mark.parametrize("loop", ["velocity", "position"])
def test_each_condition_holds_the_promised_keys(fig_5, loop):
    values = fig_5.json()[loop]
    assert set(values) >= CONDITION
    assert set(values["at"]) == AT


def test_the_promised_example_is_what_comes_out(fig_5):
    values = fig_5.json()["velocity"]
    assert round(values["worst_ratio"], 3) == 0.641
    assert round(values["margin"], 2) == 1.56
    assert values["satisfied"] is True
    assert values["nominal_stable"] is True
    assert values["at"]["mass_kg"] == 24500.0
    assert values["at"]["delay_s"] == 0.0215


def test_every_value_is_a_plain_one_that_json_knows(fig_5):
    # NaN and Infinity are no JSON: an endless or missing figure is null.
    json.dumps(fig_5.json(), allow_nan=False)


def test_unstable_plants_are_counted_and_one_is_named(fig_5_twice):
    path = fig_5_twice.json()["true_family"]["filters"]
    assert path["plants"] == len(fig_5_twice.plants.mass)
    assert path["unstable_plants"] == fig_5_twice.family("filters").unstable_count > 0
    assert path["unstable_at"]["mass_kg"] == 24500.0
    assert path["undecided_plants"] == 0


def test_every_margin_of_a_stable_family_comes_with_its_place(fig_5):
    family = fig_5.json()["true_family"]["none"]
    for loop in ("velocity_loop", "position_loop", "force_loop"):
        for figure in ("sensitivity_peak", "gain_margin", "phase_margin_rad", "delay_margin_s"):
            worst = family[loop][figure]
            assert math.isfinite(worst["worst"])
            assert set(worst["at"]) == AT


def test_every_requirement_is_listed_with_limit_and_finding(fig_5):
    requirements = fig_5.json()["requirements"]
    assert len(requirements) >= 3
    for requirement in requirements:
        assert requirement["name"]
        assert requirement["limit"]
        assert requirement["status"] == "satisfied"
        assert math.isfinite(requirement["found"])
