"""Eq. 13: the operating points of the frequency responses."""

import numpy as np
import pytest

from mptune.force.cost import supply_pressures
from mptune.params.identification import Identification


def test_the_operating_points_are_the_defaults():
    asked = Identification()
    assert asked.amplitude == 10e3
    assert asked.positions == (0.15, 0.25)
    assert asked.velocities == (-0.1, 0, 0.1)
    assert asked.oil_bulk_moduli == (800e6, 1200e6)
    assert asked.valve_delays == (0,)
    assert len(asked.pressures) == 21
    np.testing.assert_allclose(asked.pressures, np.arange(21) * 0.55e6 + 1e6)
    assert asked.pressures[-1] == 12e6


def test_supplies_are_those_of_the_boom(boom):
    supplies = boom.study.supplies
    found = supply_pressures(supplies.low_pressure, supplies.high_pressure)
    np.testing.assert_allclose(found / 1e6, [2, 4.4, 6.8, 9.2, 11.6, 14])


def test_the_largest_start_pressure_just_keeps_p_b_within_p_max(boom):
    """What the cylinder's dimensions were derived from: 12 MPa · 4/3 = 16 MPa."""
    cylinder = boom.study.cylinder
    highest = 12e6 * cylinder.area_a / cylinder.area_b
    assert highest == pytest.approx(boom.study.controller.pressure_max)
