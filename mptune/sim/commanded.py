"""What a commanded speed comes to: how the velocity follows it, and how far the piston overruns.

A speed as from a joystick is no way to a place, so that peak position error over peak velocity does
not judge it. Every figure is of the true motion; valves leave a ripple in it, which is counted.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from mptune.arrays import BoolArray, FloatArray
    from mptune.sim.record import CommandedSpeed, RunRecord


class Following(NamedTuple):
    """How a machine follows the commanded speeds of a set; NaN where there are none."""

    error: float  # m/s, root mean square of v_ref − v while a speed is commanded
    lag: float  # s, largest, from v_ref's half way up to the speed to the velocity's
    overshoot: float  # m, largest way beyond the place where the reference stopped


NOTHING_FOLLOWED = Following(np.nan, np.nan, np.nan)


def commanded_ticks(
    commands: tuple[CommandedSpeed, ...], sample_time: float, count: int
) -> BoolArray:
    """Return which of ``count`` samples belong to a commanded speed or the rest after it."""
    ticks = np.zeros(count, np.bool_)
    for one in commands:
        ticks[_places(sample_time, one.begin, one.end)] = True
    return ticks


def following(record: RunRecord) -> Following:
    """Return how a set's commanded speeds were followed."""
    if not record.commands:
        return NOTHING_FOLLOWED
    errors, lags, beyond = [], [], []
    for one in record.commands:
        moving = _places(record.sample_time, one.begin, one.stop)
        resting = _places(record.sample_time, one.stop, one.end)
        wanted, velocity = record.velocity_reference, record.velocity
        errors.append((wanted[moving] - velocity[moving]) ** 2)
        whole = _places(record.sample_time, one.begin, one.end)
        half = 0.5 * abs(one.speed)
        times = (_first(np.sign(one.speed) * v[whole], half) for v in (velocity, wanted))
        lags.append(record.sample_time * (next(times) - next(times)))
        overrun = -np.sign(one.speed) * record.error[resting]
        beyond.append(max(float(overrun.max(initial=0.0)), 0.0))
    error = float(np.sqrt(np.concatenate(errors).mean()))
    return Following(error, max(lags), max(beyond))


def _places(sample_time: float, begin: float, end: float) -> slice:
    """Return the samples between two times [s]."""
    first, last = (round(time / sample_time) for time in (begin, end))
    return slice(first, last)


def _first(values: FloatArray, level: float) -> float:
    """Return where a level is first reached, in samples; infinite where it never is."""
    reached = np.flatnonzero(values >= level)
    if len(reached) == 0:
        return np.inf
    place = int(reached[0])
    if place == 0:
        return 0.0
    before, after = values[place - 1], values[place]
    return place - float((after - level) / (after - before))
