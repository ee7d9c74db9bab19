"""Study files: what is wrong with them is said by file, key, value, rule and remedy."""

from __future__ import annotations

import pytest
from refusals import faults_of, refused

from mptune.params.load import load_study


def test_the_boom_study_loads_in_si(boom):
    assert boom.name == "boom"
    assert boom.study.cylinder.bore == 0.08
    assert boom.study.oil.bulk_modulus == (8e8, 1.4e9)
    assert boom.uncertainty.tau_a == (0.0001, 0.0122)
    assert boom.study.gains.k_p_vel == 700e3


def test_a_written_copy_of_the_boom_study_is_the_same_study(write_study, boom):
    assert load_study(write_study({})).hash() == boom.hash()


@pytest.mark.parametrize(
    ("key", "value", "rule", "remedy"),
    [
        ("cylinder.bore", '"80 MPa"', "wrong dimension (MPa)", "measured in m"),
        ("controller.weight_loss", '"80 N"', "wrong dimension", "N/J"),
        ("cylinder.bore", '"80"', "no unit", '"1 m"'),
        ("cylinder.bore", "80", "no unit", '"80 m"'),
        ("cylinder.bore", "0.08", "no unit", '"0.08 m"'),
        ("cylinder.bore", '"80 milimetre"', "unknown unit", "m"),
        ("cylinder.bore", '"eighty mm"', "number", ""),
        ("cylinder.bore", '""', "number", ""),
        ("cylinder.bore", '"0 mm"', "at least 0.005 m", "larger"),
        ("cylinder.bore", '"-80 mm"', "at least 0.005 m", "larger"),
        ("cylinder.dead_volume_a", '"-0.1 dm^3"', "at least 0 m^3", "larger"),
        ("cylinder.bore", '["80 mm"]', "number", ""),
        ("cylinder.bore", "1979-05-27", "number", ""),
        ("gains.omega", '"42 Hz"', "radians or cycles", "rad/s"),
        ("gains.omega", '"42 1/s"', "radians or cycles", "rad/s"),
        ("gains.xi", "-0.5", "at least 0", "larger"),
        ("uncertainty.points", "0", "at least 1", "larger"),
        ("uncertainty.points", "1000", "at most 51", "smaller"),
        ("uncertainty.points", "7.5", "integer", ""),
        ("uncertainty.mass", '["60 t", "20 t"]', "reversed range", "smaller value first"),
        ("uncertainty.mass", "[]", "empty range", "pair"),
        ("uncertainty.mass", '["20 t"]', "1 values", "pair"),
        ("uncertainty.mass", '["20 t", "40 t", "60 t"]', "3 values", "pair"),
        ("uncertainty.mass", '"20 t"', "single value", "pair"),
        ("uncertainty.mass", "[20, 60]", "no unit", "kg"),
        ("uncertainty.mass", '["0 t", "60 t"]', "at least 10 kg", "larger"),
        ("uncertainty.tau_a", '["-1 ms", "12 ms"]', "at least 0 s", "larger"),
        ("uncertainty.tau_a", '"12 ms"', "single value", "pair"),
        ("uncertainty.nominal.mass", '"0 kg"', "at least 10 kg", "larger"),
        ("valves.delay", '["8 ms", "5 ms"]', "reversed range", "smaller value first"),
        ("supplies.accumulator_exponent", "0.9", "at least 1", "larger"),
        ("model.measurement_path", '"filter"', "known word", "'filters'"),
        ("objective.kind", '"speed"', "known word", "'bandwidth'"),
        ("requirements.velocity_ratio", "1.5", "at most 1", "below 1"),
        ("requirements.velocity_ratio", "0", "above 0", "below 1"),
        ("requirements.velocity_ratio", "nan", "above 0", "below 1"),
        ("requirements.velocity_ratio", "true", "no ratio", "number"),
        ("requirements.velocity_ratio", '"0.7"', "no ratio", "number"),
        ("requirements.velocity_ratio", "[]", "empty curve", "pairs"),
        ("requirements.velocity_ratio", "[0.7, 0.6]", "pairs", "pairs"),
        ("requirements.velocity_ratio", '[["10 Hz", 0.7]]', "radians or cycles", "rad/s"),
        ("requirements.velocity_ratio", '[["10 rad/s", 7]]', "at most 1", "below 1"),
        ("requirements.velocity_ratio", '[["0 rad/s", 0.7]]', "not positive", "above 0"),
        (
            "requirements.velocity_ratio",
            '[["10 rad/s", 0.7], ["5 rad/s", 0.6]]',
            "do not rise",
            "rising",
        ),
        ("requirements.sensitivity_peak", "1", "greater than 1", "larger"),
        ("verification.repeats", "0", "at least 1", "larger"),
        ("title", "5", "string", ""),
        ("manoeuvre", "[]", "at least 1", ""),
    ],
)
def test_a_bad_value_is_refused(write_study, key, value, rule, remedy):
    fault = refused(write_study({key: value}), key, rule, remedy)
    assert fault.value


@pytest.mark.parametrize("value", ['"nan mm"', '"inf mm"', '"-inf mm"', "nan", "inf", '"1e999 m"'])
def test_a_value_that_is_not_finite_is_refused_as_such(write_study, value):
    refused(write_study({"cylinder.bore": value}), "cylinder.bore", "finite", "finite")


@pytest.mark.parametrize("value", ["nan", "inf", "-inf"])
def test_a_plain_number_that_is_not_finite_is_refused_as_such(write_study, value):
    refused(write_study({"gains.xi": value}), "gains.xi", "finite", "finite")


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("cylinder.bore", "true"),
        ("gains.xi", "true"),
        ("gains.xi", '"0.55"'),
        ("gains.xi", '"-0.55"'),
        ("uncertainty.points", '"0"'),
        ("uncertainty.points", "true"),
        ("requirements.sensitivity_peak", '"0.5"'),
        ("verification.seeds", "[true]"),
        ("verification.seeds", '["1"]'),
    ],
)
def test_a_value_of_the_wrong_kind_is_refused_and_not_converted(write_study, key, value):
    (fault,) = faults_of(write_study({key: value}))
    assert fault.key.startswith(key)


@pytest.mark.parametrize(
    "key",
    [
        "verification.masses",
        "verification.valve_delays",
        "verification.oil_bulk_moduli",
        "verification.load_forces",
        "verification.seeds",
    ],
)
def test_a_verification_without_a_single_case_is_refused(write_study, key):
    refused(write_study({key: "[]"}), key, "")


@pytest.mark.parametrize("value", ['"20 t"', '["20 t", "60 MPa"]'])
def test_a_refused_value_is_shown_as_it_was_written(write_study, value):
    (fault,) = faults_of(write_study({"verification.masses": value}))
    assert "20 t" in fault.value


@pytest.mark.parametrize("value", ["4", '"80 mm"', "[]"])
def test_a_value_in_place_of_a_section_is_refused(write_study, value):
    refused(write_study({"cylinder": value}), "cylinder", "")


@pytest.mark.parametrize(
    ("key", "close"),
    [
        ("cylinder.boer", "bore"),
        ("cylindre", "cylinder"),
        ("uncertainty.nominal.mas", "mass"),
        ("requirements.bounds.k_p_ves", "k_p_vel"),
    ],
)
def test_an_unknown_key_comes_with_a_suggestion(write_study, key, close):
    refused(write_study({key: '"80 mm"'}), key, "unknown key", f"`{close}`")


def test_an_unknown_key_far_from_all_others_comes_with_those_that_are_known(write_study):
    refused(write_study({"load.zzz": '"1 N"'}), "load.zzz", "unknown key", "friction_viscous")


def test_a_misspelt_key_is_named_together_with_the_missing_one(write_study):
    path = write_study({"cylinder.bore": None, "cylinder.boer": '"80 mm"'})
    assert {fault.key for fault in faults_of(path)} == {"cylinder.bore", "cylinder.boer"}


@pytest.mark.parametrize("key", ["cylinder.bore", "uncertainty.mass", "gains.tau", "oil"])
def test_a_missing_key_is_named(write_study, key):
    refused(write_study({key: None}), key, "missing", "add it")


def test_a_missing_key_inside_a_named_set_is_named(write_study):
    key = "uncertainty.sets.section-5-1.delay"
    refused(write_study({key: None}), key, "missing", "add it")


def test_a_bad_move_is_named_by_its_number(write_study):
    moves = '[{distance = "35 mm", duration = "1 s", rest = "0 s"}, {distance = "35 mm"}]'
    keys = {fault.key for fault in faults_of(write_study({"manoeuvre": moves}))}
    assert keys == {"manoeuvre[2].duration", "manoeuvre[2].rest"}


def test_every_fault_of_a_file_is_named_at_once(write_study):
    changes = {"cylinder.bore": '"80 s"', "oil.bulk_modulus": "[]", "gains.xi": "-1"}
    keys = {fault.key for fault in faults_of(write_study(changes))}
    assert keys == {"cylinder.bore", "oil.bulk_modulus", "gains.xi"}


@pytest.mark.parametrize("rod", ["80 mm", "90 mm"])
def test_a_rod_as_thick_as_the_bore_is_refused(write_study, rod):
    fault = refused(write_study({"cylinder.rod": f'"{rod}"'}), "cylinder", "not thinner", "both")
    assert "0.08 m" in fault.rule


def test_an_estimate_below_the_bulk_modulus_is_refused_for_the_sake_of_eq_12(write_study):
    path = write_study({"oil.bulk_modulus_estimate": '"700 MPa"'})
    fault = refused(path, "oil", "Eq. 12 needs B ≤ B̂", "raise the estimate")
    assert "700 MPa" in fault.rule
    assert "1400 MPa" in fault.rule


def test_an_estimate_equal_to_the_largest_bulk_modulus_is_allowed(boom):
    assert boom.study.oil.bulk_modulus_estimate == boom.study.oil.bulk_modulus[1]


@pytest.mark.parametrize("fast", ["3 ms", "20 ms", "0.6 ms"])
def test_sampling_periods_that_do_not_fit_are_refused(write_study, fast):
    path = write_study({"controller.fast_sampling_period": f'"{fast}"'})
    refused(path, "controller", "times the fast_sampling_period", "whole multiple")


@pytest.mark.parametrize("fast", ["10 ms", "0.1 ms", "2.5 ms"])
def test_sampling_periods_that_fit_are_accepted(load_boom, fast):
    controller = load_boom(f"controller.fast_sampling_period={fast}").study.controller
    assert controller.ticks * controller.fast_sampling_period == pytest.approx(0.01, rel=1e-12)


@pytest.mark.parametrize("distance", ["200 mm", "-200 mm"])
def test_a_move_beyond_the_stroke_is_refused(write_study, distance):
    move = f'[{{distance = "{distance}", duration = "1 s", rest = "1 s"}}]'
    (fault,) = faults_of(write_study({"manoeuvre": move}))
    assert "leaves the stroke" in fault.rule
    assert "number 1" in fault.rule
    assert "shorten the move" in fault.remedy


def test_moves_add_up_before_they_are_held_against_the_stroke(write_study):
    move = '{distance = "80 mm", duration = "1 s", rest = "1 s"}'
    (fault,) = faults_of(write_study({"manoeuvre": f"[{move}, {move}]"}))
    assert "number 2" in fault.rule


def test_pump_pressures_in_the_wrong_order_are_refused(write_study):
    refused(write_study({"supplies.pump_off": '"13 MPa"'}), "supplies", "not below pump_off")


def test_line_pressures_in_the_wrong_order_are_refused(write_study):
    refused(write_study({"supplies.low_pressure": '"14 MPa"'}), "supplies", "not below")


def test_one_point_for_a_range_is_refused(write_study):
    path = write_study({"uncertainty.points": "1"})
    refused(path, "uncertainty", "points = 1 but a range", "two points")


def test_a_range_without_width_is_allowed(load_boom):
    study = load_boom('uncertainty.mass=["30 t", "30 t"]')
    assert study.uncertainty.mass == (30e3, 30e3)


@pytest.mark.parametrize("objective", ["{}", '{kind = "tracking", tracking = 1}'])
def test_an_objective_is_either_a_kind_or_weights(write_study, objective):
    refused(write_study({"objective": objective}), "objective", "either a kind or weights")


@pytest.mark.parametrize(
    ("key", "source", "rule"),
    [
        ("cylindre", "published: Table 1", "no section"),
        ("cylinder", "somebody told me", "none of published, derived"),
    ],
)
def test_a_source_that_says_nothing_is_refused(write_study, key, source, rule):
    path = write_study({"sources": f'{{{key} = "{source}"}}'})
    refused(path, f"sources.{key}", rule, '"cylinder.bore" = "derived: how"')


def test_an_unknown_uncertainty_set_names_those_that_are_known(study_file):
    (fault,) = faults_of(study_file, uncertainty="section-5-2")
    assert fault.key == "uncertainty.sets"
    assert fault.value == "section-5-2"
    assert "section-5-1" in fault.remedy
