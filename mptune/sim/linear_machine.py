"""The plant of Eq. 15 in time: two lags share the force, which moves a mass, all exactly."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from mptune.arrays import kernel
from mptune.sim.lag import Fade, fade_of, held_lag_end, lag_end, lagged

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.params.packed import Plant
    from mptune.sim.lag import Cubic


class Stride(NamedTuple):
    """A step of one plant: its length, and how both sides fade over it."""

    length: float  # s
    fade_a: Fade
    fade_b: Fade


class Push(NamedTuple):
    """What the force does in one step."""

    start: float  # N, as the step begins
    end: float  # N
    side_a: float  # N, where the lags stand at the end
    side_b: float
    once: float  # N s, integrated over the step
    twice: float  # N s²


@kernel
def stride_of(plant: Plant, length: float) -> Stride:
    """Return a plant's step of that length [s]."""
    return Stride(length, fade_of(plant.tau_a, length), fade_of(plant.tau_b, length))


@kernel
def push(plant: Plant, side_a: float, side_b: float, wanted: Cubic, by: Stride) -> Push:
    """Return the force of both sides over one step.

    Parameters
    ----------
    machine
        The plant.
    side_a, side_b
        Where the lags stand: the force that all of the area would give [N].
    wanted
        The force reference as it arrives [N].
    by
        The step.
    """
    a, b = plant.share_a, 1 - plant.share_a
    lag_a, lag_b = lagged(side_a, plant.tau_a, wanted), lagged(side_b, plant.tau_b, wanted)
    start = a * (lag_a.settled.c0 + lag_a.decaying) + b * (lag_b.settled.c0 + lag_b.decaying)
    end_a, once_a, twice_a = lag_end(lag_a, by.fade_a, by.length)
    end_b, once_b, twice_b = lag_end(lag_b, by.fade_b, by.length)
    once, twice = a * once_a + b * once_b, a * twice_a + b * twice_b
    return Push(start, a * end_a + b * end_b, end_a, end_b, once, twice)


@kernel
def move_on(state: FloatArray, plant: Plant, wanted: float, by: Stride) -> None:
    """Advance side A, side B, velocity and position, ``(4,)``, under a held force reference [N]."""
    a, b = plant.share_a, 1 - plant.share_a
    end_a, once_a, twice_a = held_lag_end(state[0], wanted, by.fade_a, by.length)
    end_b, once_b, twice_b = held_lag_end(state[1], wanted, by.fade_b, by.length)
    state[0], state[1] = end_a, end_b
    state[3] += by.length * state[2] + (a * twice_a + b * twice_b) / plant.mass
    state[2] += (a * once_a + b * once_b) / plant.mass
