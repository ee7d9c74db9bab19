"""Eq. 19 and Eq. 20: the position plant with its velocity loop closed, and its error."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.loops.position import closed_velocity, position_error
from mptune.loops.velocity import nominal_velocity
from mptune.params.packed import NominalPlant


def test_the_closed_velocity_loop_is_an_integrator_at_low_frequency():
    s = 1e-4j
    velocity = nominal_velocity(s, NominalPlant(24500.0, 0.011))
    closed = closed_velocity(s, velocity, velocity * 7e5, 7e5)
    assert closed == pytest.approx(1 / s, rel=1e-4)


def test_without_delay_the_closed_velocity_loop_is_a_lag_before_an_integrator():
    s = 2 + 30j
    velocity = 1 / (24500 * s)
    closed = closed_velocity(s, velocity, velocity * 7e5, 7e5)
    assert closed == pytest.approx(1 / (s * (24500 / 7e5 * s + 1)), rel=1e-13)


def test_no_velocity_error_is_no_position_error():
    assert position_error(0j, 0.3 - 2j) == 0


def test_feedback_shrinks_the_error_by_the_return_difference_of_the_true_loop():
    error, loop = 0.2 - 0.4j, 3 - 9j
    true_loop = (1 + error) * loop
    assert position_error(error, loop) == pytest.approx(error / (1 + true_loop), rel=1e-14)


def test_with_a_weak_velocity_loop_both_errors_are_the_same():
    error = np.exp(0.7j)
    assert position_error(error, 1e-12j) == pytest.approx(error, rel=1e-11)
