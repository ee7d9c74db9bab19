"""Eq. 11 and Eq. 12: the force loop, and the time constants of the chamber pressures."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.loops.family import derived_time_constants, plants_of, time_constants_at
from mptune.loops.force_dynamics import force_dynamics, pressure_time_constant


def test_g_f_is_the_sum_of_two_pressures_each_lagging_by_its_own_time_constant():
    # F = A_A p_A − A_B p_B with p_A,ref, p_B,ref = p_0 ± F_ref/(A_A + A_B)
    area_a, area_b, tau_a, tau_b = 50.27e-4, 37.70e-4, 0.0122, 0.0119
    s = 1j * np.geomspace(0.1, 1e4, 50)
    by_hand = area_a / (area_a + area_b) / (tau_a * s + 1)
    by_hand += area_b / (area_a + area_b) / (tau_b * s + 1)
    found = force_dynamics(s, tau_a, tau_b, area_a / (area_a + area_b))
    np.testing.assert_allclose(found, by_hand, rtol=1e-12)


def test_eq_12_by_hand():
    # 800 of 1400 MPa at 10 ms: −10/ln(1 − 4/7) = 10/ln(7/3)
    tau = float(pressure_time_constant(8e8, 1.4e9, 0.010))
    print(f"τ at 800 of 1400 MPa: {tau * 1e3:.2f} ms")
    assert tau == pytest.approx(0.010 / np.log(7 / 3), rel=1e-14)
    assert round(tau * 1e3, 2) == 11.80


def test_a_known_bulk_modulus_leaves_no_lag():
    assert pressure_time_constant(1.4e9, 1.4e9, 0.010) == 0.0


def test_eq_12_keeps_its_digits_where_the_estimate_is_far_off():
    # −T/ln(1 − r) → T/r for small r
    assert float(pressure_time_constant(1e-9, 1.0, 0.01)) == pytest.approx(1e7, rel=1e-8)


@pytest.mark.parametrize("modulus", [1.5e9, 0.0, -8e8, float("nan")])
def test_eq_12_refuses_a_bulk_modulus_that_is_not_between_zero_and_its_estimate(modulus):
    with pytest.raises(ValueError, match="raise the estimate"):
        pressure_time_constant(modulus, 1.4e9, 0.010)


@pytest.mark.parametrize(
    ("period", "tau_a", "tau_b"), [("10 ms", 10.21, 9.94), ("12 ms", 12.25, 11.93)]
)
def test_the_largest_time_constants_of_the_derived_cylinder(load_boom, period, tau_a, tau_b):
    study = load_boom(f"controller.sampling_period={period}")
    range_a, range_b = derived_time_constants(study)
    print(f"T_S = {period}: τ_A ≤ {range_a[1] * 1e3:.2f} ms, τ_B ≤ {range_b[1] * 1e3:.2f} ms")
    assert round(range_a[1] * 1e3, 2) == tau_a
    assert round(range_b[1] * 1e3, 2) == tau_b
    assert range_a[0] == range_b[0] == 0.0


@pytest.mark.parametrize("bore", ["40 mm", "80 mm", "500 mm"])
def test_no_geometry_reaches_the_paper_s_time_constants_at_its_sampling_period(load_boom, bore):
    ceiling = 0.010 / np.log(7 / 3)
    study = load_boom(f"cylinder.bore={bore}", "cylinder.rod=20 mm", "hose.length_a=0 m")
    for least, largest in derived_time_constants(study):
        assert least <= largest <= ceiling * (1 + 1e-12)


def test_the_extremes_of_the_derived_ranges_are_those_of_the_whole_box(load_boom):
    study = load_boom()
    machine = study.study
    position = np.linspace(0, machine.cylinder.stroke, 31)
    modulus = np.linspace(*machine.oil.bulk_modulus, 31)[:, None]
    volume = machine.cylinder.area_b * (machine.cylinder.stroke - position)
    volume += machine.cylinder.dead_volume_b + machine.hose.volume(machine.hose.length_b)
    compliance = machine.hose.volume(machine.hose.length_b) / volume / machine.hose.bulk_modulus
    ratio = (1 / machine.oil.bulk_modulus_estimate + compliance) / (1 / modulus + compliance)
    with np.errstate(divide="ignore"):
        tau = -0.010 / np.log1p(-np.minimum(ratio, 1))
    assert derived_time_constants(study)[1] == pytest.approx((tau.min(), tau.max()), rel=1e-9)


@pytest.mark.parametrize("position", [0.05, 0.25])
def test_each_side_s_time_constant_follows_its_own_volume(boom, position):
    """Where the piston stands, Eq. 4 and Eq. 12 by hand: A's volume grows, B's shrinks."""
    machine = boom.study
    cylinder, hose = machine.cylinder, machine.hose
    found = time_constants_at(boom, 8e8, position)
    for tau, swept in zip(
        found,
        (cylinder.area_a * position, cylinder.area_b * (cylinder.stroke - position)),
        strict=True,
    ):
        hoses = (
            hose.volume(hose.length_a)
            / (swept + cylinder.dead_volume_a + hose.volume(hose.length_a))
            / 6e8
        )
        ratio = (1 / 1.4e9 + hoses) / (1 / 8e8 + hoses)
        assert float(tau) == pytest.approx(-0.010 / np.log(1 - ratio), rel=1e-9)


def test_a_derived_range_becomes_an_axis_of_the_family(load_boom):
    study = load_boom("uncertainty.tau_a=derived", "uncertainty.tau_b=derived")
    plants = plants_of(study)
    assert (plants.tau_a.min(), plants.tau_a.max()) == derived_time_constants(study)[0]
    assert (plants.tau_b.min(), plants.tau_b.max()) == derived_time_constants(study)[1]
