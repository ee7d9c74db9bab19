"""Eq. 9 and Eq. 10: when the valves are shut and when the controller wakes."""

import numpy as np
import pytest

from mptune.force.stop import stopped
from mptune.params.pack import pack_signals


@pytest.fixture(scope="module")
def signals(boom):
    return pack_signals(boom.study.controller)


def test_tolerances_are_those_of_table_2(signals):
    found = signals.velocity_tolerance, signals.stop_tolerance, signals.start_tolerance
    assert found == pytest.approx((1e-4, 5e-4, 7e-4), rel=1e-12)


@pytest.mark.parametrize(
    ("was", "error", "velocity", "expected"),
    [
        (False, 0.49e-3, 0.0, True),  # Eq. 9
        (False, -0.49e-3, -0.9e-4, True),
        (False, 0.51e-3, 0.0, False),
        (False, 0.0, 1.1e-4, False),
        (False, 0.6e-3, 0.0, False),  # between both tolerances it stays as it was
        (True, 0.6e-3, 0.0, True),
        (True, -0.6e-3, 0.0, True),
        (True, 0.71e-3, 0.0, False),  # Eq. 10
        (True, -0.71e-3, 0.0, False),
        (True, 0.0, 1.1e-4, False),
        (True, 0.0, -1.1e-4, False),
    ],
)
def test_each_corner_of_the_logic(signals, was, error, velocity, expected):
    assert bool(stopped(was, error, velocity, signals)) is expected


def test_limits_themselves_count_as_within(signals):
    assert stopped(False, signals.stop_tolerance, signals.velocity_tolerance, signals)
    assert stopped(True, signals.start_tolerance, signals.velocity_tolerance, signals)


def test_an_error_that_sweeps_up_and_down_draws_a_hysteresis(signals):
    """It stops below 0.5 mm and starts above 0.7 mm: two changes in one sweep up and down."""
    sweep = np.concatenate([np.linspace(1e-3, 0, 201), np.linspace(0, 1e-3, 201)])
    was, changes = False, []
    for error in sweep:
        now = bool(stopped(was, error, 0.0, signals))
        if now != was:
            changes.append(float(error))
        was = now
    print(f"stopped at {1e3 * changes[0]:.3f} mm, started at {1e3 * changes[1]:.3f} mm")
    assert changes == pytest.approx([5e-4, 7e-4], abs=6e-6)
