"""Rules of size: what they are made of, which way they go, and that following advice ends it."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mptune.params import sizing
from mptune.params.advice import advice_on, advised
from mptune.params.bundled import bundled_studies
from mptune.params.load import load_study
from mptune.params.template import write_template
from mptune.units import parse_quantity

LITRE = 1e-3
FACTORS = st.floats(0.2, 20)
DERIVED = ('uncertainty.delay="derived"', 'uncertainty.delay_as_it_runs="derived"')


def changed(study, **sections):
    """Return a study with values of its sections replaced, in SI."""
    update = {
        name: getattr(study, name).model_copy(update=values) for name, values in sections.items()
    }
    return study.model_copy(update=update)


def moved(study, factor):
    """Return a study whose moves are so many times as long, in as many times the time."""
    moves = tuple(
        one.model_copy(
            update={"distance": factor * one.distance, "duration": factor * one.duration}
        )
        for one in study.manoeuvre
    )
    return study.model_copy(update={"manoeuvre": moves})


def keys_of(study):
    return [one.keys[0] for one in advice_on(study)]


# What the rules are made of ---------------------------------------------------------------------


def test_a_way_s_oil_is_its_work_over_the_supplies_span(boom):
    """70 mm against 9.7 − 2.5 kN of load and 22.1 kN of loss, over 12 MPa: 0.171 dm³."""
    study, most = boom.study, sizing.most_taken(boom.study)
    assert study.manoeuvre[most.move].distance == 0.07
    step = 12e6 / 5
    areas = study.cylinder.area_a + study.cylinder.area_b
    lost = areas * step + 750 + 4000 * 0.07 / 1.25
    lifted = 9700 - (study.cylinder.area_a - study.cylinder.area_b) * 2e6
    assert most.way == pytest.approx(0.07 * (lost + lifted) / 12e6, rel=1e-12)


def test_the_accumulator_falls_as_its_gas_does(boom):
    """4 dm³ at 10 MPa have 3.145 dm³ of gas at 14 MPa; p V^n stays."""
    gas = 4 * LITRE * (10 / 14) ** (1 / 1.4)
    left = sizing.pressure_left(boom.study, 0.2 * LITRE)
    assert left * (gas + 0.2 * LITRE) ** 1.4 == pytest.approx(14e6 * gas**1.4, rel=1e-12)
    assert sizing.pressure_left(boom.study, 0) == pytest.approx(14e6, rel=1e-12)
    assert sizing.pressure_left(boom.study, 4 * LITRE) == 10e6  # empty


def test_what_is_advised_holds_the_pressure_to_the_pascal(boom):
    volume = sizing.least_accumulator(boom.study, 10e6)
    small = changed(boom.study, supplies={"accumulator_volume": volume})
    left = sizing.pressure_left(small, sizing.most_taken(small).way)
    assert left == pytest.approx(0.9 * 14e6, rel=1e-9)


def test_a_converter_takes_what_the_larger_chamber_sweeps(boom):
    swept = boom.study.cylinder.area_a * 0.07
    assert sizing.least_converter(boom.study) == pytest.approx(1.25 * swept / 2)


def test_a_pump_keeps_up_with_a_move_and_its_rest(boom):
    most = sizing.most_taken(boom.study)
    assert sizing.least_pump(boom.study) == pytest.approx(most.way / 2.25)


# Which way they go ------------------------------------------------------------------------------


@given(st.floats(1.01, 20))
def test_longer_ways_ask_for_more_of_everything(boom, factor):
    study = boom.study
    longer = moved(study, factor)
    ratio = sizing.least_accumulator(longer, 10e6) / sizing.least_accumulator(study, 10e6)
    assert ratio == pytest.approx(factor)
    assert sizing.least_converter(longer) == pytest.approx(factor * sizing.least_converter(study))
    assert sizing.least_pump(longer) > sizing.least_pump(study)  # its rest is as long as it was


@given(st.floats(1.01, 10), st.floats(1.01, 10))
def test_larger_pistons_and_loads_take_more_oil(boom, larger, heavier):
    """The load above what the tank line carries, which grows with the areas."""
    study = boom.study
    bore, rod, force = study.cylinder.bore, study.cylinder.rod, study.load.force
    wide = changed(study, cylinder={"bore": larger * bore, "rod": larger * rod})
    loads = {"load_forces": tuple(heavier * one for one in study.verification.load_forces)}
    heavy = changed(study, load={"force": heavier * force}, verification=loads)
    assert sizing.most_taken(wide).way > sizing.most_taken(study).way
    assert sizing.most_taken(heavy).way > sizing.most_taken(study).way
    assert sizing.most_friction(wide) == pytest.approx(larger**2 * sizing.most_friction(study))


@given(st.floats(1.01, 5))
def test_a_longer_travel_needs_a_smaller_weight(boom, factor):
    study = boom.study
    travel = study.supplies.converter_travel
    longer = changed(study, supplies={"converter_travel": factor * travel})
    for one, other in zip(
        sizing.converter_weights(study), sizing.converter_weights(longer), strict=True
    ):
        assert other == pytest.approx(one / factor**3)


def test_a_chamber_s_larger_valves_need_a_smaller_weight(load_shape):
    """Twice the oil through the valves of all that pushes; pulling chambers have no part in it."""
    study = load_shape("four-converters").study
    larger = tuple(
        one.model_copy(update={"valves": (2 if one.side == "pushing" else 3) * one.valves})
        for one in study.chambers
    )
    found = sizing.converter_weights(study.model_copy(update={"chambers": larger}))
    assert found == pytest.approx([one / 2 for one in sizing.converter_weights(study)])


# Advice -----------------------------------------------------------------------------------------


@given(st.floats(1e-9, 1e9), st.sampled_from(["m", "m^2", "m^3", "m^3/s", "Pa", "s", "N"]))
def test_an_advised_size_reads_back_on_the_safe_side(value, unit):
    above, below = (parse_quantity(advised(value, unit, up=up), unit) for up in (True, False))
    assert below * (1 - 1e-8) <= value <= above * (1 + 1e-8)
    assert above <= 1.11 * value
    assert below >= 0.9 * value


@given(FACTORS, FACTORS, FACTORS, FACTORS, st.floats(0.5, 1.3))
def test_whoever_follows_the_advice_hears_it_no_more(boom, size, flow, area, move, gas):
    """Of supplies, filters and friction that are anything between small and large."""
    had = boom.study
    study = changed(
        moved(had, move),
        supplies={
            "accumulator_volume": size * had.supplies.accumulator_volume,
            "accumulator_precharge": gas * had.supplies.accumulator_precharge,
            "pump_flow": flow * had.supplies.pump_flow,
            "converter_area": area * had.supplies.converter_area,
        },
        controller={
            "weight_converter": size * had.controller.weight_converter,
            "pressure_filter": flow * had.controller.pressure_filter,
            "position_filter": area * had.controller.position_filter,
            "supply_filter": size * had.controller.supply_filter,
        },
        load={"friction_static": area * had.load.friction_static},
    )
    assert keys_of(followed(study)) == []


def followed(study):
    """Return a study with every piece of advice taken from its text."""
    for doubt in advice_on(study):
        section, _, name = doubt.keys[0].partition(".")
        text = doubt.remedy
        if name == "accumulator_volume":
            volume, _, more = text.partition(" would hold")[0].partition(" with a precharge of ")
            values = {name: parse_quantity(volume, "m^3")}
            if more:
                values["accumulator_precharge"] = parse_quantity(more, "Pa")
        elif name == "pump_flow":
            values = {name: between(text, "a pump of ", ",", "m^3/s")}
        elif name == "converter_area":
            values = {name: between(text, "take ", " at that", "m^2")}
        elif name == "weight_converter":
            values = {name: between(text, None, " makes", "N s/m^6")}
        elif name.endswith("filter"):
            values = {name: between(text, None, " would do", "s")}
        else:
            values = {name: between(text, "have about ", ",", "N")}
        study = changed(study, **{section: values})
    return study


def between(text, before, after, unit):
    rest = text.split(before, 1)[-1] if before else text
    return parse_quantity(rest.partition(after)[0], unit)


@pytest.mark.parametrize("name", [*bundled_studies()])
def test_the_bundled_studies_follow_their_own_advice(name):
    doubts = load_study(bundled_studies()[name]).doubts
    assert [one.keys[0] for one in doubts] == (["uncertainty.delay"] if name == "boom" else [])


def test_the_template_follows_it_too(tmp_path):
    assert load_study(write_template(tmp_path, "mine")).doubts == ()


@pytest.mark.parametrize(
    ("override", "key", "words"),
    [
        ("supplies.accumulator_volume=1 dm^3", "supplies.accumulator_volume", "2.8 dm³ would hold"),
        ("supplies.accumulator_precharge=13.5 MPa", "supplies.accumulator_volume", "10.08 MPa"),
        ("supplies.pump_flow=3 l/min", "supplies.pump_flow", "4.6 l/min"),
        ("supplies.converter_travel=60 mm", "supplies.converter_area", "37 cm²"),
        ("controller.weight_converter=2e13 N s/m^6", "controller.weight_converter", "weights"),
        ("controller.weight_converter=0 N s/m^6", "controller.weight_converter", "ends"),
        ("controller.position_filter=20 ms", "controller.position_filter", "14 ms would do"),
        ("controller.pressure_filter=8 ms", "controller.pressure_filter", "5 ms would do"),
        ("controller.supply_filter=0.2 s", "controller.supply_filter", "120 ms would do"),
        ("load.friction_static=4 kN", "load.friction_static", "about 1.4 kN"),
    ],
)
def test_what_is_outgrown_is_said_with_the_size_that_would_do(study_file, override, key, words):
    doubts = load_study(study_file, [*DERIVED, override]).doubts
    assert doubts[0].keys[0] == key
    assert words in str(doubts[0])


def test_a_limit_that_is_a_sum_is_advised_as_it_would_be_written():
    study = load_study(bundled_studies()["fast"], ["controller.position_filter=12 ms"])
    assert "4.3 ms would do" in str(study.doubts[0])  # 1.5, 2.5 and 0.3 ms


def test_an_accumulator_that_runs_empty_is_said_to(boom):
    small = changed(boom.study, supplies={"accumulator_volume": 0.2 * LITRE})
    (doubt,) = advice_on(small)
    assert "runs empty at 10 MPa" in doubt.rule


def test_lines_of_constant_pressure_are_no_matter_of_size():
    study = load_study(bundled_studies()["three-pressure"]).study
    assert math.isinf(study.supplies.pump_flow)
    assert keys_of(moved(study, 2)) == []


def test_a_state_estimator_has_no_position_filter_to_be_slow(boom):
    slow = changed(boom.study, controller={"position_filter": 0.05})
    assert keys_of(slow) == ["controller.position_filter"]
    assert keys_of(changed(slow, estimator={"kind": "state"})) == []
