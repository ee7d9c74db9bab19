"""Position references as pieces of polynomials, with velocity and acceleration (§6).

Every shape of reference is a table of pieces, one row each: the time at which the piece begins and
the six coefficients of a polynomial in the time since. Builders of the usual shapes give such rows
for a move that begins at time 0 and position 0.
"""

from __future__ import annotations

import numpy as np

from mptune.arrays import FloatArray, kernel

COLUMNS = 7  # begin, c_0 … c_5
_PIECES_PER_CYCLE = 48  # of a sine: the position's error is then below 1e-8 of its amplitude


@kernel
def piece_at(time: float, pieces: FloatArray) -> int:
    """Return the number of the last piece that has begun at a time [s]; 0 before the first."""
    low, high = 0, len(pieces) - 1
    while low < high:
        middle = (low + high + 1) // 2
        if pieces[middle, 0] <= time:
            low = middle
        else:
            high = middle - 1
    return low


@kernel
def jerk(time: float, pieces: FloatArray) -> float:
    """Return the third derivative of the position at a time; as of ``reference`` [m/s³]."""
    low = piece_at(time, pieces)
    t = max(time - pieces[low, 0], 0.0)
    found: float = 6 * pieces[low, 4] + t * (24 * pieces[low, 5] + t * 60 * pieces[low, 6])
    return found


@kernel
def reference(time: float, pieces: FloatArray) -> tuple[float, float, float]:
    """Return position, velocity and acceleration at a time.

    Parameters
    ----------
    time
        Time since the first piece began [s]; before it, its start is held.
    pieces
        ``(P, 7)`` begin [s] and coefficients c_0 [m] to c_5 [m/s⁵], begins rising.
    """
    low = piece_at(time, pieces)
    t = max(time - pieces[low, 0], 0.0)
    c0, c1, c2 = pieces[low, 1], pieces[low, 2], pieces[low, 3]
    c3, c4, c5 = pieces[low, 4], pieces[low, 5], pieces[low, 6]
    position = c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * c5))))
    velocity = c1 + t * (2 * c2 + t * (3 * c3 + t * (4 * c4 + t * 5 * c5)))
    acceleration = 2 * c2 + t * (6 * c3 + t * (12 * c4 + t * 20 * c5))
    return position, velocity, acceleration


def quintic(distance: float, duration: float) -> FloatArray:
    """Return a fifth-order polynomial move from rest to rest; its peak velocity is 1.875 A/T."""
    row = np.zeros((1, COLUMNS))
    row[0, 4:] = distance * np.array([10, -15, 6]) / duration ** np.arange(3, 6)
    return row


def trapezoid(distance: float, duration: float, ramp_share: float) -> FloatArray:
    """Return a move with constant acceleration, constant velocity and constant deceleration.

    ``ramp_share`` of the duration, at most one half, goes into each of both ramps.
    """
    ramp = ramp_share * duration
    speed = distance / (duration - ramp)
    return _chained([(ramp, 0.0, speed / ramp), (duration - 2 * ramp, 0.0, 0.0),
                     (ramp, 0.0, -speed / ramp)])  # fmt: skip


def s_curve(distance: float, duration: float, ramp_share: float) -> FloatArray:
    """Return a move whose acceleration rises and falls linearly: limited jerk."""
    ramp = ramp_share * duration
    jerk = distance / (duration - ramp) / (ramp / 2) ** 2
    half, peak = ramp / 2, jerk * ramp / 2
    cruise = (duration - 2 * ramp, 0.0, 0.0)
    up = [(half, jerk, 0.0), (half, -jerk, peak)]
    down = [(half, -jerk, 0.0), (half, jerk, -peak)]
    return _chained([*up, cruise, *down])


def _chained(pieces: list[tuple[float, float, float]]) -> FloatArray:
    """Return rows from (duration, jerk, acceleration at the begin), continuous in velocity."""
    rows, begin, position, velocity = [], 0.0, 0.0, 0.0
    for duration, jerk, start in pieces:
        rows.append([begin, position, velocity, start / 2, jerk / 6, 0.0, 0.0])
        t = duration
        position += velocity * t + start * t**2 / 2 + jerk * t**3 / 6
        velocity += start * t + jerk * t**2 / 2
        begin += t
    return np.array(rows)


def sine(distance: float, duration: float, cycles: float) -> FloatArray:
    """Return ``distance``/2 · (1 − cos(2π cycles t/duration)), as pieces of polynomials."""
    count = int(np.ceil(cycles * _PIECES_PER_CYCLE))
    rate = 2 * np.pi * cycles / duration
    step = duration / count
    begin = step * np.arange(count + 1, dtype=np.float64)
    position = distance / 2 * (1 - np.cos(rate * begin))
    velocity = distance / 2 * rate * np.sin(rate * begin)
    acceleration = distance / 2 * rate**2 * np.cos(rate * begin)
    return through(begin, position, velocity, acceleration)


def through(
    begin: FloatArray, position: FloatArray, velocity: FloatArray, acceleration: FloatArray
) -> FloatArray:
    """Return the quintic pieces through given positions, velocities and accelerations."""
    h = np.diff(begin)
    p, v, a = position[:-1], velocity[:-1], acceleration[:-1]
    gap = position[1:] - p - v * h - a * h**2 / 2
    gap_v = (velocity[1:] - v - a * h) * h
    gap_a = (acceleration[1:] - a) * h**2
    c3 = (10 * gap - 4 * gap_v + gap_a / 2) / h**3
    c4 = (-15 * gap + 7 * gap_v - gap_a) / h**4
    c5 = (6 * gap - 3 * gap_v + gap_a / 2) / h**5
    return np.column_stack([begin[:-1], p, v, a / 2, c3, c4, c5])
