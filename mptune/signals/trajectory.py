"""Position references: smooth moves between rests, with velocity and acceleration (§6)."""

from __future__ import annotations

from mptune.arrays import FloatArray, kernel


@kernel
def quintic(time: float, distance: float, duration: float) -> tuple[float, float, float]:
    """Return position, velocity and acceleration of a fifth-order polynomial move from rest.

    The peak velocity is 1.875 distance/duration.

    Parameters
    ----------
    time
        Time since the move began [s]; before it the piston rests, after it too.
    distance
        Signed length of the move [m].
    duration
        Time of the move [s].
    """
    share = min(max(time / duration, 0.0), 1.0)
    rest = 1 - share
    position = share**3 * (10 - 15 * share + 6 * share**2)
    velocity = 30 * (share * rest) ** 2
    acceleration = 60 * share * rest * (1 - 2 * share)
    return (
        distance * position,
        distance / duration * velocity,
        distance / duration**2 * acceleration,
    )


@kernel
def reference(time: float, moves: FloatArray) -> tuple[float, float, float]:
    """Return position, velocity and acceleration of a sequence of moves.

    Parameters
    ----------
    time
        Time since the first move began [s].
    moves
        ``(M, 3)``: distance [m], duration [s] and rest [s] of each move.
    """
    position, velocity, acceleration = 0.0, 0.0, 0.0
    begin = 0.0
    for move in range(len(moves)):
        if time < begin:
            break
        step, speed, rate = quintic(time - begin, moves[move, 0], moves[move, 1])
        position += step
        velocity += speed
        acceleration += rate
        begin += moves[move, 1] + moves[move, 2]
    return position, velocity, acceleration
