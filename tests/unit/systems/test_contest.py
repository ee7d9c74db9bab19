"""The comparison as a whole, on made-up systems; what is calibrated is varied."""

from __future__ import annotations

import json

import numpy as np
import pytest

from mptune.figures.systems import _ticks_among, loss_over_index
from mptune.job.kept_rows import checked_rows
from mptune.params.load import load_study
from mptune.report.content.systems import compared
from mptune.sim.record import BrokenLimit, Energies, RunRecord
from mptune.systems.compare import calibrated_keys, contest, load_cases, with_value
from mptune.systems.contender import Contender, Tuned, outcome_of


def record(error, loss, broken=()):
    """A second at 0.1 m/s, ``error`` [m] behind, 0.1 m of travel."""
    rows = np.zeros(1000)
    return RunRecord(
        sample_time=1e-3,
        position_reference=rows + error,
        velocity_reference=rows + 0.08,
        position=rows,
        velocity=rows + 0.1,
        force_reference=rows + np.nan,
        force=rows,
        active=rows == 0,
        ends=np.array([1.0]),
        travel=0.1,
        energies=Energies(100 + loss, 100 + loss, -5.0, 100.0, {"throttling": loss - 5.0}),
        broken=broken,
    )


def made_up(name, error, least_stable_repeats=0):
    def run(case, factor):
        broken = (BrokenLimit("it broke", 0.0),) if factor < least_stable_repeats else ()
        return outcome_of(
            record(error * case.mass / 1e5, 2000.0 * factor, broken) for _ in range(case.repeats)
        )

    return Tuned(name, "gains", run)


@pytest.fixture
def result(boom):
    def build(study):
        value = study.study.systems.digital_valves.margin / 2.2e6
        one = made_up("literature", 5e-3 * value)
        yield Contender("digital_valves", "one", "here", one, (made_up("better", 2e-3),))
        yield Contender("load_sensing", "two", "there", made_up("literature", 1e-3))
        yield Contender("four_chamber", "three", "there", made_up("literature", 1e-3))
        yield Contender("steady_state", "four", "there", made_up("literature", 1e-3))

    stages = []
    found = contest(boom, build, lambda stage, share: stages.append((stage, share)))
    assert {stage for stage, _ in stages} == {"best controllers", "systems", "calibrated values"}
    assert stages[-1] == ("calibrated values", 1.0)
    return found


def test_every_system_is_shown_by_its_literature_and_by_a_better_controller(result):
    shown = [(run.title, run.controller, run.best, run.mass_kg) for run in result.runs]
    assert shown == [
        (title, name, best, mass)
        for title, name, best in (
            ("one", "literature", False),
            ("one", "better", True),
            ("two", "literature", True),
            ("three", "literature", True),
            ("four", "literature", True),
        )
        for mass in (24.5e3, 49e3)
    ]


def test_figures_of_a_run_by_hand(result):
    outcome = result.runs[1].outcome  # 49 t, 2.45 mm behind at 100 mm/s
    assert len(outcome.sets) == 8  # of nine, the first left out
    assert outcome.mean("performance_index_ms") == pytest.approx(24.5)
    assert outcome.reference_index_ms == pytest.approx(24.5 * 100 / 80)
    assert outcome.mean("energy_loss_j_per_mm") == pytest.approx(20.0)
    assert outcome.returned_j_per_mm == pytest.approx(0.05)
    assert outcome.spread("performance_index_ms") == 0
    row = result.json()["runs"][1]
    assert row["force_error_integral_kn2s"] is None
    assert row["stable"] is True


def test_what_is_calibrated_is_varied_on_the_largest_mass(result):
    found = {one.key: one for one in result.calibrated}
    margin = found["systems.digital_valves.margin"]
    assert margin.index_ms == pytest.approx((24.5 * 0.8, 24.5, 24.5 * 1.2))
    assert margin.loss_j_per_mm == pytest.approx((20, 20, 20))
    assert margin.unit == "Pa"
    assert margin.source.startswith("calibrated: on the 29 J/mm")


def test_what_is_left_for_the_report_is_taken_in_its_own_shape_alone(result):
    rows = json.loads(json.dumps(result.rows()))
    assert checked_rows("systems", rows) == tuple(rows)
    for key, value in (("kind", "system"), ("title", 3), ("energy_residual", "1e-14")):
        with pytest.raises(ValueError, match=r"another shape, at rows\.0"):
            checked_rows("systems", [{**rows[0], key: value}, *rows[1:]])
    with pytest.raises(ValueError, match="another shape"):
        checked_rows("systems", [*rows[:-1], {**rows[-1], "performance_index_ms": [1.0, 2.0]}])


def test_every_calibrated_value_says_on_what(boom):
    keys = calibrated_keys(boom)
    assert len(keys) >= 8
    for key in keys:
        assert boom.study.source_of(key).startswith("calibrated: ")
        assert "assumed" not in boom.study.source_of(key)


def test_every_value_of_a_system_has_a_least_and_a_largest(boom):
    for name in type(boom.study.systems).model_fields:
        part = getattr(boom.study.systems, name)
        for key, field in getattr(type(part), "model_fields", {}).items():
            assert field.json_schema_extra["at_least"] is not None, f"systems.{name}.{key}"
            assert field.json_schema_extra["at_most"] is not None, f"systems.{name}.{key}"


def test_one_value_changes_and_the_model_stays_the_same(boom):
    other = with_value(boom, "systems.load_sensing.play", 1.5)
    assert other.study.systems.load_sensing.play == pytest.approx(0.015)
    assert other.study.systems.digital_valves == boom.study.systems.digital_valves
    assert other.hash() == boom.hash()


def test_each_mass_is_run_with_the_middle_oil(boom, study_file):
    assert [case.mass for case in load_cases(boom)] == [24.5e3, 49e3]
    assert {case.oil_bulk_modulus for case in load_cases(boom)} == {1.2e9}
    one = load_study(study_file, ["systems.repeats=3"])
    assert {case.repeats for case in load_cases(one)} == {3}


@pytest.mark.parametrize(
    ("value", "key", "rule"),
    [
        ('systems.digital_valves.ramp="9 ms"', "systems.digital_valves", "ramp longer"),
        ('systems.four_chamber.low_pressure="13 MPa"', "systems.four_chamber", "low_pressure"),
        ("systems.load_sensing.dead_band_known=1.2", "dead_band_known", "at most 1"),
        ("systems.repeats=1", "systems.repeats", "at least 2"),
        ('systems.cascade_loop.k_i="1e11 N/m"', "systems.cascade_loop", "k_i above"),
    ],
)
def test_bad_values_are_refused_by_name(study_file, value, key, rule):
    from mptune.errors import InputError

    with pytest.raises(InputError) as error:
        load_study(study_file, [value])
    assert key in str(error.value)
    assert rule in str(error.value)


def test_what_the_paper_tells_stands_on_the_mass_that_it_tells_it_of(result):
    row = result.runs[-1].json()
    told = {}
    for system in ("this_machine", "steady_state", "load_sensing", "beside_1"):
        for mass in (24.5e3, 49e3, 60e3):
            shown = compared([{**row, "system": system, "mass_kg": mass}]).rows[0]
            told[system, mass] = (shown[5], shown[7])
    assert told["this_machine", 24.5e3] == ("13–30", "19.5")
    assert told["this_machine", 49e3] == ("18–34", "18.9")
    assert told["steady_state", 24.5e3] == ("–", "–")
    assert told["steady_state", 49e3] == ("–", "15.9")
    assert told["load_sensing", 24.5e3] == told["load_sensing", 49e3] == ("> 100", "45")
    assert told["beside_1", 49e3] == told["load_sensing", 60e3] == ("–", "–")


def test_a_system_is_named_though_its_literature_s_run_did_not_stand(result):
    rows = [{**row, "stable": row.get("controller") != "literature"} for row in result.rows()]
    axes = loss_over_index(rows).axes[0]
    assert axes.get_legend_handles_labels()[1] == ["one"]
    assert [line.get_markerfacecolor() for line in axes.lines if line.get_marker() == "o"] == [
        "white"
    ]


def test_no_mass_is_drawn_beyond_the_axes():
    """The panels share them, and the second one's loss is the larger."""
    rows = [
        {"kind": "run", "stable": True, "system": "this_machine", "title": "this machine",
         "mass_kg": mass, "controller": "literature", "performance_index_ms": 2.0,
         "energy_loss_j_per_mm": loss}
        for mass, loss in ((300.0, 2.0), (600.0, 3.0))
    ]  # fmt: skip
    for axes in loss_over_index(rows).axes:
        assert axes.get_ylim()[0] == 0
        assert axes.get_ylim()[1] > 3


@pytest.mark.parametrize(
    ("least", "most", "ticks"),
    [
        (4.7, 150.0, [5, 10, 20, 30, 50, 100]),
        (2.7, 2100.0, [3, 10, 30, 100, 300, 1000]),
        (2.0, 1e6, [10, 100, 1000, 10_000, 100_000, 1_000_000]),
    ],
)
def test_texts_beside_a_wide_axis_stay_apart(least, most, ticks):
    found = _ticks_among([least, most])
    assert [tick for tick in found if least <= tick <= most] == ticks
