"""A study checked as a whole: what is refused, what is doubted, and what is fine."""

from __future__ import annotations

import json

import pytest

from mptune.errors import InputError
from mptune.params.load import load_study

PLAIN = ('uncertainty.delay="derived"', 'uncertainty.delay_as_it_runs="derived"')
TABLE = "position [mm],force [kN],inertia [-]\n0,{},{}\n300,{},{}\n"


@pytest.fixture(scope="module")
def load(study_file):
    """Load the boom study without its own doubts, with overrides."""

    def loaded(*overrides, uncertainty=""):
        # The moduli tried hold both ends of the oil's range, and one between them.
        return load_study(study_file, [*PLAIN, *overrides], uncertainty)

    return loaded


def doubt(study):
    (found,) = study.doubts
    assert len(found.keys) == len(found.values)
    assert found.rule
    assert found.remedy
    for key, value in zip(found.keys, found.values, strict=True):
        assert f"`{key}` = {value}" in str(found)
    json.dumps(found.json(), allow_nan=False)
    assert list(found.json()["values"]) == list(found.keys)
    return found


def refusal(load, *overrides):
    with pytest.raises(InputError) as caught:
        load(*overrides)
    (fault,) = caught.value.faults
    return fault


def test_the_boom_with_derived_delays_is_fine(load):
    assert load().doubts == ()


def test_the_paper_s_own_study_has_one_doubt_fig_5_s_delays(boom):
    found = doubt(boom)
    assert found.keys[0] == "uncertainty.delay"
    assert found.values == ("11–21.5 ms", "10 ms", "5–8 ms", "0–1 ms")
    assert "10–14 ms" in found.rule
    assert 'delay = "derived"' in found.remedy


# Delays -----------------------------------------------------------------------------------------


def test_derived_delays_are_the_sum_of_5_1(load):
    study = load()
    assert study.uncertainty.lumped_delay == pytest.approx((0.010, 0.014))
    assert study.uncertainty.explicit_delay == study.uncertainty.lumped_delay
    slower = load("controller.sampling_period=14 ms", 'valves.computation_delay=["0 ms", "3 ms"]')
    assert slower.uncertainty.lumped_delay == pytest.approx((0.012, 0.018))


def test_each_delay_that_is_no_sum_is_doubted_by_itself(load):
    runs = load('uncertainty.delay_as_it_runs=["9 ms", "14 ms"]')
    assert doubt(runs).keys[0] == "uncertainty.delay_as_it_runs"
    both = load(
        'uncertainty.delay=["9 ms", "14 ms"]', 'uncertainty.delay_as_it_runs=["9 ms", "15 ms"]'
    )
    assert [one.keys[0] for one in both.doubts] == [
        "uncertainty.delay",
        "uncertainty.delay_as_it_runs",
    ]


def test_one_range_for_both_delays_is_doubted_once(load):
    pair = '["9 ms", "14 ms"]'
    study = load(f"uncertainty.delay={pair}", f"uncertainty.delay_as_it_runs={pair}")
    assert doubt(study).keys[0] == "uncertainty.delay"


def test_the_doubt_names_the_set_that_was_chosen(load):
    delay = 'uncertainty.sets.section-5-1.delay=["9 ms", "14 ms"]'
    assert load(uncertainty="section-5-1").doubts == ()
    found = doubt(load(delay, uncertainty="section-5-1"))
    assert found.keys[0] == "uncertainty.sets.section-5-1.delay"


# Valves -----------------------------------------------------------------------------------------


def test_valves_slower_than_the_sampling_period_are_refused_before_any_work(load):
    fault = refusal(load, 'valves.delay=["5 ms", "10 ms"]')
    assert (fault.key, fault.value) == ("valves.delay", "10 ms")
    assert "controller.sampling_period = 10 ms" in fault.rule
    assert load('valves.delay=["5 ms", "9.9 ms"]').doubts == ()


def test_the_steady_state_decision_may_be_slower_than_its_valves(load):
    study = load('valves.delay=["5 ms", "10 ms"]', "controller.force_model=steady-state")
    assert study.doubts == ()


def test_slow_valves_that_are_not_tried_are_doubted_only(load):
    study = load('valves.delay=["5 ms", "12 ms"]', 'verification.valve_delays=["7 ms"]')
    keys = [one.keys for one in study.doubts]
    assert ("valves.delay", "controller.sampling_period") in keys
    assert ("verification.valve_delays", "valves.delay") in keys
    assert len(keys) == 2


def test_what_is_tried_is_named_where_it_is_written(load):
    fault = refusal(load, 'verification.valve_delays=["7 ms", "12 ms"]')
    assert fault.key == "verification.valve_delays[2]"


# Forces -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("load_force", "held"), [("78 kN", True), ("79 kN", False)])
def test_a_load_beyond_the_pressures_is_refused(load, load_force, held):
    """A_A p_max − A_B p_min = 80.4 − 1.9 kN."""
    if held:
        assert [one.keys[0] for one in load(f"load.force={load_force}").doubts] == [
            "load.force",
            "manoeuvre[1]",
            "supplies.accumulator_volume",
            "supplies.pump_flow",
        ]
        return
    fault = refusal(load, f"load.force={load_force}")
    assert fault.key == "load.force"
    assert "78.54 kN" in fault.rule
    assert "controller.pressure_max = 16 MPa" in fault.rule


def test_a_load_that_pulls_too_hard_is_refused_and_so_is_one_that_grows(load):
    """A_A p_min − A_B p_max = 2.5 − 60.3 kN."""
    assert "-57.81 kN" in refusal(load, "load.force=-58 kN").rule
    assert load("load.force=-15 kN").doubts == ()
    fault = refusal(load, 'load.stiffness="1000 kN/m"')  # 70 mm from the start: 9.7 + 70 kN
    assert "79.7 kN" in fault.rule
    assert "79.7 kN" not in refusal(load, 'load.stiffness="2000 kN/m"').rule


def test_what_acceleration_asks_for_counts_too(load):
    """49 t at 5.77 · 70 mm/T²: 12.7 kN in 1.25 s, 79 kN in 0.5 s."""
    quick = 'manoeuvre=[{distance="70 mm", duration="0.5 s", rest="5 s"}]'
    found = next(one for one in load(quick).doubts if one.keys[0] == "load.force")
    assert found.keys[1] == "supplies.high_pressure"
    assert "62.83 kN" in found.rule  # A_A 14 MPa − A_B 2 MPa


# Flows ------------------------------------------------------------------------------------------


def test_a_move_too_fast_for_the_valves_is_doubted(load):
    """With K_v an eighth the piston comes to 32 mm/s against the load, and is to make 105."""
    assert load("valves.flow_coefficient=1.2e-7 m^3/(s Pa^0.5)").doubts == ()
    weight = "controller.weight_converter=1.6e12 N s/m^6"  # an eighth of the oil, eight times dear
    found = doubt(load("valves.flow_coefficient=0.3e-7 m^3/(s Pa^0.5)", weight))
    assert found.keys == ("manoeuvre[1]", "valves.flow_coefficient")
    assert "32.5" in found.rule


# Machines that are tried ------------------------------------------------------------------------


def test_what_is_left_out_of_the_verification_follows_the_study(load):
    study = load(
        'uncertainty.mass=["20 t", "60 t"]', "load.force=5 kN", 'valves.delay=["4 ms", "7 ms"]'
    )
    asked = study.study.verification
    assert asked.masses == (20e3, 60e3)
    assert asked.valve_delays == ((4e-3, 7e-3),)
    assert asked.load_forces == (5e3,)
    assert study.doubts == ()


def test_masses_follow_the_chosen_set_and_one_mass_is_one_case(load):
    narrow = 'uncertainty.sets.section-5-1.mass=["30 t", "30 t"]'
    assert load(narrow, uncertainty="section-5-1").study.verification.masses == (30e3,)


@pytest.mark.parametrize(
    ("override", "keys"),
    [
        ('verification.masses=["30 t"]', ("verification.masses", "uncertainty.mass")),
        ('verification.valve_delays=["6 ms"]', ("verification.valve_delays", "valves.delay")),
        (
            'verification.oil_bulk_moduli=["1200 MPa"]',
            ("verification.oil_bulk_moduli", "oil.bulk_modulus"),
        ),
        ('verification.load_forces=["5 kN"]', ("verification.load_forces", "load.force")),
    ],
)
def test_other_machines_than_the_study_s_are_doubted(load, override, keys):
    found = doubt(load(override))
    assert found.keys == keys
    assert keys[0] in found.remedy


def test_more_loads_than_the_study_s_own_are_fine(load):
    assert load('verification.load_forces=["5 kN", "9.7 kN", "12 kN"]').doubts == ()


@pytest.mark.parametrize(("left", "right", "fine"), [(1, 1, True), (0.25, 0.3, False)])
def test_the_table_s_inertia_is_held_against_the_mass(write_study, tmp_path, left, right, fine):
    """The family is swept at 24.5 to 49 t while the machine has 6 to 15 t."""
    (tmp_path / "boom.csv").write_text(TABLE.format(0, left, 0, right))
    study = load_study(write_study({"load.table": '"boom.csv"'}), PLAIN)
    if fine:
        assert study.doubts == ()
        return
    found = doubt(study)
    assert found.keys == ("load.table", "uncertainty.mass")
    assert found.values[1] == "24500–49000 kg"
    assert "6738–14047 kg" in found.rule  # 0.275 and 0.287 at 150 and 220 mm


def test_a_table_s_force_counts_where_the_moves_go(write_study, tmp_path):
    """80 kN more at the end of the stroke are 58.7 kN at 220 mm."""
    (tmp_path / "boom.csv").write_text(TABLE.format(0, 1, 80, 1))
    fine = {"load.table": '"boom.csv"'}
    keys = [one.keys[0] for one in load_study(write_study(fine), PLAIN).doubts]
    assert keys[:2] == ["load.force", "manoeuvre[1]"]
    (tmp_path / "boom.csv").write_text(TABLE.format(0, 1, 95, 1))
    with pytest.raises(InputError, match=r"79\.37 kN"):
        load_study(write_study(fine), PLAIN)


# Moves ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["quintic", "trapezoid", "s-curve", "sine"])
def test_peaks_and_travel_of_a_move_are_those_of_its_reference(load, kind):
    import numpy as np

    from mptune.signals.trajectory import reference
    from mptune.sim.moves import moves_of

    text = f'manoeuvre=[{{kind="{kind}", distance="70 mm", duration="2 s", rest="0 s"}}]'
    (move,) = load(text).study.manoeuvre
    pieces = moves_of([move]).pieces
    rows = np.array([reference(t, pieces) for t in np.linspace(0, 2, 20001)[1:-1]])
    assert np.abs(rows[:, 1]).max() == pytest.approx(move.peak_velocity, rel=1e-3)
    assert np.abs(rows[:, 2]).max() == pytest.approx(move.peak_acceleration, rel=5e-3)
    assert np.abs(np.diff(rows[:, 0])).sum() == pytest.approx(move.travel, rel=1e-3)
    assert move.extends
    assert move.retracts == (kind == "sine")
