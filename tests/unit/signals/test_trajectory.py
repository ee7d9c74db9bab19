"""References: from rest to rest, with consistent derivatives, whatever their shape."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mptune.signals import trajectory
from mptune.signals.trajectory import reference

distances = st.floats(0.001, 0.3) | st.floats(-0.3, -0.001)
durations = st.floats(0.1, 5.0)
shapes = st.sampled_from(
    [
        trajectory.quintic,
        lambda distance, duration: trajectory.trapezoid(distance, duration, 0.3),
        lambda distance, duration: trajectory.s_curve(distance, duration, 0.5),
        lambda distance, duration: trajectory.sine(distance, duration, 2),
    ]
)


@given(shape=shapes, distance=distances, duration=durations)
def test_every_shape_begins_and_ends_at_rest(shape, distance, duration):
    pieces = shape(distance, duration)
    begin, end = reference(0.0, pieces), reference(duration, pieces)
    speed = abs(distance) / duration
    assert begin[0] == pytest.approx(0, abs=1e-12)
    assert begin[1] == pytest.approx(0, abs=1e-9 * speed)
    assert end[1] == pytest.approx(0, abs=1e-6 * speed)


@given(distance=distances, duration=durations, share=st.floats(0.05, 0.5))
def test_moves_cover_their_distance(distance, duration, share):
    for pieces in (
        trajectory.quintic(distance, duration),
        trajectory.trapezoid(distance, duration, share),
        trajectory.s_curve(distance, duration, share),
    ):
        assert reference(duration, pieces)[0] == pytest.approx(distance, rel=1e-9)


@given(shape=shapes, distance=distances, duration=durations, share=st.floats(0.01, 0.99))
def test_velocity_is_the_slope_of_position(shape, distance, duration, share):
    pieces = shape(distance, duration)
    time, step = share * duration, 1e-6 * duration
    before, after = (reference(time + sign * step, pieces)[0] for sign in (-1, 1))
    speed = abs(distance) / duration
    slope = (after - before) / (2 * step)
    assert slope == pytest.approx(reference(time, pieces)[1], abs=1e-4 * speed)


@given(distance=distances, duration=durations, share=st.floats(0.01, 0.99))
def test_acceleration_of_the_s_curve_never_jumps(distance, duration, share):
    pieces = trajectory.s_curve(distance, duration, 0.4)
    jerk = abs(distance) / (0.6 * duration) / (0.2 * duration) ** 2
    time, step = share * duration, 1e-6 * duration
    change = reference(time + step, pieces)[2] - reference(time - step, pieces)[2]
    assert abs(change) <= 2.001 * jerk * step + 1e-9


def test_peak_velocity_of_the_70_mm_move_is_105_mm_s():
    """§6: 70 mm in 1.25 s give 105 mm/s."""
    assert reference(0.625, trajectory.quintic(0.07, 1.25))[1] == pytest.approx(0.105)


def test_sine_follows_the_cosine_it_stands_for():
    pieces = trajectory.sine(0.1, 2.0, 3)
    time = np.linspace(0, 2, 997)
    found = np.array([reference(instant, pieces)[0] for instant in time])
    expected = 0.05 * (1 - np.cos(2 * np.pi * 3 * time / 2))
    error = np.abs(found - expected).max()
    print(f"sine from pieces: {error:.1e} of {0.05} m")
    assert error < 1e-8 * 0.05
