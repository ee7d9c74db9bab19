"""References: rest to rest, with consistent derivatives."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mptune.signals.trajectory import quintic, reference

distances = st.floats(-0.3, 0.3)
durations = st.floats(0.1, 5.0)


@given(distance=distances, duration=durations)
def test_quintic_goes_from_rest_to_rest(distance, duration):
    assert quintic(0.0, distance, duration) == (0.0, 0.0, 0.0)
    position, velocity, acceleration = quintic(duration, distance, duration)
    assert position == pytest.approx(distance)
    assert velocity == pytest.approx(0)
    assert acceleration == pytest.approx(0)


@given(distance=distances, duration=durations, share=st.floats(0.01, 0.99))
def test_quintic_derivatives_are_those_of_its_position(distance, duration, share):
    time, step = share * duration, 1e-5 * duration
    before, after = (quintic(time + sign * step, distance, duration) for sign in (-1, 1))
    _, velocity, acceleration = quintic(time, distance, duration)
    scale = abs(distance) / duration + 1e-12
    assert (after[0] - before[0]) / (2 * step) == pytest.approx(velocity, abs=1e-6 * scale)
    slope = (after[1] - before[1]) / (2 * step)
    assert slope == pytest.approx(acceleration, abs=1e-6 * scale / duration)


def test_peak_velocity_of_the_70_mm_move_is_105_mm_s():
    """§6: 70 mm in 1.25 s give 105 mm/s."""
    assert quintic(0.625, 0.07, 1.25)[1] == pytest.approx(0.105)


def test_moves_add_up_and_rest_between():
    moves = np.array([[0.035, 1.25, 1.0], [-0.035, 1.25, 1.0], [0.07, 1.25, 1.0]])
    assert reference(2.0, moves) == (pytest.approx(0.035), 0.0, 0.0)
    assert reference(4.4, moves)[0] == pytest.approx(0.0, abs=1e-15)
    assert reference(100.0, moves)[0] == pytest.approx(0.07)
