"""Table 1, Table 2 and the other numbers that the paper prints, as the boom study has them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mptune.loops.family import plants_of
from mptune.params.load import load_study
from mptune.params.pack import pack_nominal
from mptune.params.paper import LEDGER, MEASURED_INDEX_RANGE, PUBLISHED_GAINS


def test_table_1(boom):
    cylinder, hose, valves = boom.study.cylinder, boom.study.hose, boom.study.valves
    assert cylinder.dead_volume_a == pytest.approx(0.4e-3, rel=1e-15)
    assert cylinder.dead_volume_b == cylinder.dead_volume_a
    assert hose.volume(hose.length_a) == pytest.approx(math.pi / 4 * 0.019**2 * 0.8, rel=1e-15)
    assert hose.volume(hose.length_b) == hose.volume(hose.length_a)
    assert valves.flow_coefficient == 2.357e-7
    assert hose.bulk_modulus == 600e6


def test_the_flow_coefficient_is_ten_litres_per_minute_at_half_a_megapascal(boom):
    flow = boom.study.valves.flow_coefficient * math.sqrt(0.5e6)
    assert flow * 60e3 == pytest.approx(10, rel=1e-4)


def test_table_2_gains(boom):
    gains = boom.study.gains
    assert gains == PUBLISHED_GAINS
    assert (gains.k_p_vel, gains.k_p_pos, gains.k_i_pos) == (700000, 13, 22)
    assert (gains.omega, gains.tau, gains.xi) == (42, 0.006, 0.55)


def test_table_2_settings(boom):
    controller = boom.study.controller
    assert (controller.sampling_period, controller.fast_sampling_period) == (0.010, 0.0005)
    assert controller.ticks == 20
    assert controller.dead_zone == 0.0007
    assert controller.weight_switching == 100
    assert controller.weight_loss == 80
    assert controller.weight_converter == 2e11
    assert (controller.pressure_min, controller.pressure_max) == (0.5e6, 16e6)
    assert controller.velocity_tolerance == 0.0001
    assert controller.position_tolerance_stop == 0.0005
    assert controller.position_tolerance_start == 0.0007


def test_the_filters_of_section_5_2(boom):
    controller = boom.study.controller
    assert controller.pressure_filter == 0.0045
    assert controller.position_filter == 0.012
    assert controller.supply_filter == 0.024
    assert controller.converter_backlash == 0.0001


def test_the_bulk_moduli_of_section_5_1(boom):
    assert boom.study.oil.bulk_modulus == (800e6, 1400e6)
    assert boom.study.oil.bulk_modulus_estimate == 1400e6


def test_the_ranges_of_fig_5_have_seven_equally_spaced_values_each(boom):
    plants = plants_of(boom)
    assert len(plants.mass) == 7**4
    for column, low, high in (
        (plants.mass, 24500, 49000),
        (plants.delay, 0.011, 0.0215),
        (plants.tau_a, 0.0001, 0.0122),
        (plants.tau_b, 0.0001, 0.0119),
    ):
        values = np.unique(column)
        np.testing.assert_allclose(values, np.linspace(low, high, 7), rtol=1e-12)
        assert (values[0], values[-1]) == (low, high)


def test_the_ranges_of_section_5_1(study_file):
    box = load_study(study_file, uncertainty="section-5-1").uncertainty
    assert box.mass == (24500, 49000)
    assert box.delay == (0.010, 0.014)
    assert box.tau_a == (0.0001, 0.0122)
    assert box.tau_b == (0.0001, 0.0119)


@pytest.mark.parametrize(("name", "delay"), [("", 0.011), ("section-5-1", 0.010)])
def test_the_nominal_plant_has_the_least_mass_and_delay(study_file, name, delay):
    nominal = pack_nominal(load_study(study_file, uncertainty=name))
    assert nominal == (24500, delay)


def test_the_delay_of_section_5_1_adds_up(boom, study_file):
    valves, half = boom.study.valves, boom.study.controller.sampling_period / 2
    box = load_study(study_file, uncertainty="section-5-1").uncertainty
    for end in range(2):
        total = half + valves.delay[end] + valves.computation_delay[end]
        assert box.delay[end] == pytest.approx(total, rel=1e-12)


def test_the_cylinder_s_area_ratio_keeps_p_b_of_eq_13_within_its_limit(boom):
    cylinder = boom.study.cylinder
    assert cylinder.area_a / cylinder.area_b == pytest.approx(4 / 3, rel=1e-12)
    assert 12e6 * cylinder.area_a / cylinder.area_b == pytest.approx(
        boom.study.controller.pressure_max, rel=1e-12
    )
    assert boom.study.share_a == pytest.approx(4 / 7, rel=1e-12)


def test_the_moves_are_those_of_section_6(boom):
    moves = boom.study.manoeuvre
    assert {abs(move.distance) for move in moves} == {0.035, 0.07}
    assert {move.duration for move in moves} == {1.25}
    assert sum(move.distance for move in moves) == pytest.approx(0, abs=1e-15)


def test_the_measured_index_ranges_of_section_7_2():
    assert MEASURED_INDEX_RANGE == {24500.0: (0.0131, 0.0304), 49000.0: (0.0181, 0.0337)}


def test_every_entry_of_the_ledger_says_where_what_and_why():
    for entry in LEDGER:
        assert entry.where
        assert entry.reads
        assert entry.used
        assert len(entry.why) > 20


@pytest.mark.parametrize(
    "where", ["Eq. 11", "Eq. 6", "W_conv", "maxima of τ_A and τ_B", "System delay", "Eq. 17"]
)
def test_the_ledger_holds_each_known_disagreement(where):
    assert any(where in entry.where for entry in LEDGER)
