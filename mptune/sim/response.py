"""Time responses of the continuous closed loop with exact dead time, for a whole family.

The method of steps: the dead time is a whole number of steps, so that over each step the plant's
input is past history, known as a cubic polynomial. Lags and integrators are advanced exactly for
that cubic, and the controller likewise for the cubic through the measured position and its
slope. Kinks that a step of the reference sends round the loop fall on step boundaries, where left
and right limits are kept apart. The error is that of the cubic interpolation, of fourth order in
the step. A state estimator is none of it: what runs with one is sampled, and its steps are those of
``mptune.sim.running_steps``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numba
import numpy as np

from mptune.arrays import FloatArray, kernel, parallel_kernel
from mptune.loops.velocity import plant_at
from mptune.params.packed import LoopGains
from mptune.signals.differentiator import DIVISOR, WEIGHTS
from mptune.signals.trajectory import reference
from mptune.sim.lag import Cubic, fade_of, hermite, integral, lag_end, lagged, value_and_slope
from mptune.sim.linear_machine import push, stride_of

if TYPE_CHECKING:
    from mptune.loops.family import FamilyLoops
    from mptune.params.packed import MeasurementPath, Plant, Plants
    from mptune.sim.lag import Fade

_LONGEST_STEP = 5e-4  # s; and no longer than a sample of the measurement path
_MOST_STEPS = 100_000  # that a response drawn is followed: 50 s
_AT_REST = np.zeros((1, 7))


def farthest(loops: FamilyLoops) -> float:
    """Return how long a response may be drawn [s]: so many steps of the plant of the shortest."""
    longest = min(_LONGEST_STEP, loops.path.sample_time or _LONGEST_STEP)
    return _MOST_STEPS * min(longest, float(loops.plants.delay.min()))


def velocity_step(loops: FamilyLoops, time: FloatArray) -> FloatArray:
    """Return the velocity after a unit step of the velocity reference, ``(N, T)``.

    The position loop is open. ``time`` ``(T,)`` rises from 0 [s].
    """
    gains = LoopGains(loops.gains.k_p_vel, 0.0, 0.0, 1.0, 0.0, 1.0)
    return _responses(loops.plants, gains, loops.path, time, _AT_REST, (1.0, 0.0, 0.0))[:, :, 1]


def position_step(loops: FamilyLoops, time: FloatArray) -> FloatArray:
    """Return the position after a unit step of the position reference alone, ``(N, T)``."""
    return _of_position(loops, time, (0.0, 1.0, 0.0))


def load_step(loops: FamilyLoops, time: FloatArray) -> FloatArray:
    """Return the position after a step of the load force, per newton, ``(N, T)`` [m/N].

    A positive load pushes against positive motion, as in Eq. 1.
    """
    return _of_position(loops, time, (0.0, 0.0, 1.0))


def _of_position(
    loops: FamilyLoops, time: FloatArray, levels: tuple[float, float, float]
) -> FloatArray:
    return _responses(loops.plants, loops.gains, loops.path, time, _AT_REST, levels)[:, :, 0]


def tracking(
    loops: FamilyLoops, time: FloatArray, pieces: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return position and velocity, ``(N, T)`` each, for moves with velocity feed-forward.

    ``pieces`` ``(P, 7)`` is the reference, see ``mptune.signals.trajectory``.
    """
    levels = (0.0, 0.0, 0.0)
    found = _responses(loops.plants, loops.gains, loops.path, time, pieces, levels)
    return found[:, :, 0], found[:, :, 1]


@parallel_kernel
def _responses(
    plants: Plants,
    gains: LoopGains,
    path: MeasurementPath,
    time: FloatArray,
    pieces: FloatArray,
    levels: tuple[float, float, float],
) -> FloatArray:
    """Return positions and velocities ``(N, T, 2)``.

    ``levels`` are the steps of velocity reference, position reference and load force at time 0.
    """
    if path.estimator_mass > 0:
        raise ValueError("a state estimator's steps are those of mptune.sim.running_steps")
    count = len(plants.mass)
    found = np.empty((count, len(time), 2))
    for n in numba.prange(count):
        _response(plant_at(plants, n), gains, path, time, pieces, levels, found[n])
    return found


@kernel
def _past(values: FloatArray, slopes: FloatArray, time: float, step: float) -> tuple[float, float]:
    """Return value and slope of a stored signal at an earlier time; rest before time 0."""
    if time <= 0:
        return 0.0, 0.0
    k = min(int(time / step), len(values) - 2)
    cubic = hermite(values[k], slopes[k], values[k + 1], slopes[k + 1], step)
    return value_and_slope(cubic, time - k * step)


@kernel
def _measured(
    k: int,
    step: float,
    path: MeasurementPath,
    x: FloatArray,
    v: FloatArray,
    y: FloatArray,
    dy: FloatArray,
) -> tuple[float, float]:
    """Note filtered position and slope at step k; return measured velocity and its slope.

    Median and filter together are y(t) = a y(t − T) + (1 − a) x(t − T); then Eq. 23.
    """
    now, sample = k * step, path.sample_time
    old, old_slope = _past(y, dy, now - sample, step)
    raw, raw_slope = _past(x, v, now - sample, step)
    y[k] = path.filter_pole * old + (1 - path.filter_pole) * raw
    dy[k] = path.filter_pole * old_slope + (1 - path.filter_pole) * raw_slope
    velocity, slope = 0.0, 0.0
    for tap in range(len(WEIGHTS)):
        value, rate = _past(y, dy, now - tap * sample, step)
        if tap == 0:
            value, rate = y[k], dy[k]
        weight = WEIGHTS[tap] / (DIVISOR * sample)  # Eq. 23
        velocity += weight * value
        slope += weight * rate
    return velocity, slope


class _Shaped(NamedTuple):
    """What Eq. 22 carries on."""

    lag1: float  # m, e/(τs + 1)
    lag2: float  # m, e/(τs + 1)²
    integral: float  # m s, of e


@kernel
def _command(
    gains: LoopGains,
    shaped: _Shaped,
    error: tuple[float, float],
    velocity_error: tuple[float, float],
) -> tuple[float, float]:
    """Return F_ref = K_P,vel (v_ref + G_P (x_ref − x) − v) and its slope.

    Parameters
    ----------
    gains
        The gains.
    shaped
        The states of Eq. 22.
    error, velocity_error
        x_ref − x and v_ref − v as measured, each with its slope.
    """
    lag1, lag2 = shaped.lag1, shaped.lag2
    corner = gains.tau * gains.omega
    lag1_slope, lag2_slope = (error[0] - lag1) / gains.tau, (lag1 - lag2) / gains.tau
    damped = 2 * gains.xi / corner
    shape = (error[0] - 2 * lag1 + lag2) / corner**2 + damped * (lag1 - lag2) + lag2
    shape_slope = (
        (error[1] - 2 * lag1_slope + lag2_slope) / corner**2
        + damped * (lag1_slope - lag2_slope)
        + lag2_slope
    )
    position = gains.k_p_pos * shape + gains.k_i_pos * shaped.integral  # Eq. 22
    position_slope = gains.k_p_pos * shape_slope + gains.k_i_pos * error[0]
    force = gains.k_p_vel * (velocity_error[0] + position)  # Eq. 18
    return force, gains.k_p_vel * (velocity_error[1] + position_slope)


@kernel
def _shaped_on(shaped: _Shaped, error: Cubic, fade: Fade, step: float) -> _Shaped:
    """Return the states of Eq. 22 after a step of a cubic error."""
    tau = fade.tau
    first = lagged(shaped.lag1, tau, error)
    # The first lag's exponential drives the second at its own pole: C t/τ e^{−t/τ}.
    second = lag_end(lagged(shaped.lag2, tau, first.settled), fade, step)[0]
    second += first.decaying * step / tau * fade.left
    return _Shaped(lag_end(first, fade, step)[0], second, shaped.integral + integral(error, step))


@kernel
def _response(
    plant: Plant,
    gains: LoopGains,
    path: MeasurementPath,
    time: FloatArray,
    pieces: FloatArray,
    levels: tuple[float, float, float],
    found: FloatArray,
) -> None:
    """Fill ``found`` ``(T, 2)`` with position and velocity of one plant."""
    mass, load = plant.mass, levels[2]
    longest = _LONGEST_STEP if path.sample_time == 0 else min(_LONGEST_STEP, path.sample_time)
    behind = int(np.ceil(plant.delay / longest))
    h = plant.delay / behind
    steps = int(time[-1] / h) + 1
    stride, fade = stride_of(plant, h), fade_of(gains.tau, h)
    force = np.zeros((steps, 4))  # F_ref over each step: start, slope, end, slope
    x, v, y, dy = np.zeros(steps + 1), np.zeros(steps + 1), np.zeros(steps + 1), np.zeros(steps + 1)
    side_a, side_b, shaped = 0.0, 0.0, _Shaped(0.0, 0.0, 0.0)
    measured, measured_slope, out = 0.0, 0.0, 0
    r, v_ref, a_ref = reference(0.0, pieces)
    error = (levels[1] + r, v_ref)
    for k in range(steps):
        past = Cubic(0.0, 0.0, 0.0, 0.0)
        if k >= behind:
            row = force[k - behind]
            past = hermite(row[0], row[1], row[2], row[3], h)
        pushed = push(plant, side_a, side_b, past, stride)
        side_a, side_b = pushed.side_a, pushed.side_b
        start, end = pushed.start - load, pushed.end - load
        if path.sample_time == 0:
            measured, measured_slope = v[k], start / mass
        ahead = (levels[0] + v_ref - measured, a_ref - measured_slope)
        force[k, 0], force[k, 1] = _command(gains, shaped, error, ahead)

        v[k + 1] = v[k] + (pushed.once - load * h) / mass
        x[k + 1] = x[k] + h * v[k] + (pushed.twice - load * h * h / 2) / mass
        if path.sample_time == 0:
            y[k + 1], dy[k + 1] = x[k + 1], v[k + 1]
            measured, measured_slope = v[k + 1], end / mass
        else:
            measured, measured_slope = _measured(k + 1, h, path, x, v, y, dy)

        r, v_ref, a_ref = reference((k + 1) * h, pieces)
        after = (levels[1] + r - y[k + 1], v_ref - dy[k + 1])
        errors = hermite(error[0], error[1], after[0], after[1], h)
        error, shaped = after, _shaped_on(shaped, errors, fade, h)
        ahead = (levels[0] + v_ref - measured, a_ref - measured_slope)
        force[k, 2], force[k, 3] = _command(gains, shaped, error, ahead)

        positions = hermite(x[k], v[k], x[k + 1], v[k + 1], h)
        velocities = hermite(v[k], start / mass, v[k + 1], end / mass, h)
        while out < len(time) and time[out] <= (k + 1) * h:
            found[out, 0] = value_and_slope(positions, time[out] - k * h)[0]
            found[out, 1] = value_and_slope(velocities, time[out] - k * h)[0]
            out += 1
    found[out:, 0], found[out:, 1] = x[steps], v[steps]  # rounding left the last instant outside
