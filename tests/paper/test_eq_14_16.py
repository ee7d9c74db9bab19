"""Eq. 14 to Eq. 16: the velocity plant, nominal and true, and the error between them."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.loops.velocity import nominal_velocity, true_velocity, velocity_error
from mptune.params.packed import NominalPlant, Plant

NOMINAL = NominalPlant(mass=24500.0, delay=0.011)
SAME = Plant(mass=24500.0, delay=0.011, tau_a=0.0, tau_b=0.0, share_a=0.57)


def test_the_nominal_plant_is_a_mass_behind_a_delay():
    found = nominal_velocity(50j, NOMINAL)
    assert abs(found) == pytest.approx(1 / (24500 * 50), rel=1e-14)
    assert np.angle(found) == pytest.approx(-np.pi / 2 - 50 * 0.011, rel=1e-12)


def test_the_true_plant_without_lags_is_a_nominal_plant():
    plant = SAME._replace(mass=3e4, delay=0.015)
    assert true_velocity(3 + 50j, plant) == nominal_velocity(3 + 50j, NominalPlant(3e4, 0.015))


def test_the_error_of_the_nominal_plant_is_exactly_zero():
    assert velocity_error(50j, SAME, NOMINAL) == 0


def test_the_error_of_mass_alone_is_its_ratio_less_one():
    error = velocity_error(50j, SAME._replace(mass=49000.0), NOMINAL)
    assert error == pytest.approx(-0.5, rel=1e-15)


def test_the_error_of_delay_alone_turns_on_a_circle():
    error = velocity_error(50j, SAME._replace(delay=0.0215), NOMINAL)
    assert abs(error) == pytest.approx(2 * np.sin(50 * 0.0105 / 2), rel=1e-13)
