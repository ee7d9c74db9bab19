"""Time responses of the continuous closed loop with exact dead time, for a whole family.

The method of steps: the dead time is a whole number of steps, so that over each step the plant's
input is past history, known as a cubic polynomial. Lags and integrators are advanced exactly for
that cubic, and the controller likewise for the cubic through the measured position and its
slope. Kinks that a step of the reference sends round the loop fall on step boundaries, where left
and right limits are kept apart. The error is that of the cubic interpolation, of fourth order in
the step.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numba
import numpy as np

from mptune.arrays import FloatArray, kernel, parallel_kernel
from mptune.signals.trajectory import reference

if TYPE_CHECKING:
    from mptune.params.pack import LoopGains, MeasurementPath, Plants

_LONGEST_STEP = 5e-4  # s; and no longer than a sample of the measurement path
_AT_REST = np.zeros((1, 7))


def velocity_step(
    plants: Plants, share_a: float, k_p_vel: float, path: MeasurementPath, time: FloatArray
) -> FloatArray:
    """Return the velocity after a unit step of the velocity reference, ``(N, T)``.

    The position loop is open. ``time`` ``(T,)`` rises from 0 [s].
    """
    from mptune.params.pack import LoopGains

    gains = LoopGains(k_p_vel, 0.0, 0.0, 1.0, 0.0, 1.0)
    levels = (1.0, 0.0, 0.0)
    return _responses(plants, share_a, gains, path, time, _AT_REST, levels)[:, :, 1]


def position_step(
    plants: Plants, share_a: float, gains: LoopGains, path: MeasurementPath, time: FloatArray
) -> FloatArray:
    """Return the position after a unit step of the position reference alone, ``(N, T)``."""
    levels = (0.0, 1.0, 0.0)
    return _responses(plants, share_a, gains, path, time, _AT_REST, levels)[:, :, 0]


def load_step(
    plants: Plants, share_a: float, gains: LoopGains, path: MeasurementPath, time: FloatArray
) -> FloatArray:
    """Return the position after a step of the load force, per newton, ``(N, T)`` [m/N].

    A positive load pushes against positive motion, as in Eq. 1.
    """
    levels = (0.0, 0.0, 1.0)
    return _responses(plants, share_a, gains, path, time, _AT_REST, levels)[:, :, 0]


def tracking(
    plants: Plants,
    share_a: float,
    gains: LoopGains,
    path: MeasurementPath,
    time: FloatArray,
    pieces: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return position and velocity, ``(N, T)`` each, for moves with velocity feed-forward.

    ``pieces`` ``(P, 7)`` is the reference, see ``mptune.signals.trajectory``.
    """
    found = _responses(plants, share_a, gains, path, time, pieces, (0.0, 0.0, 0.0))
    return found[:, :, 0], found[:, :, 1]


@parallel_kernel
def _responses(
    plants: Plants,
    share_a: float,
    gains: LoopGains,
    path: MeasurementPath,
    time: FloatArray,
    pieces: FloatArray,
    levels: tuple[float, float, float],
) -> FloatArray:
    """Return positions and velocities ``(N, T, 2)``.

    ``levels`` are the steps of velocity reference, position reference and load force at time 0.
    """
    count = len(plants.mass)
    found = np.empty((count, len(time), 2))
    for n in numba.prange(count):
        plant = (plants.mass[n], plants.delay[n], plants.tau_a[n], plants.tau_b[n], share_a)
        _response(plant, gains, path, time, pieces, levels, found[n])
    return found


@kernel
def _lag(
    start: float, tau: float, cubic: tuple[float, float, float, float], step: float
) -> tuple[float, float, float, float, float, float]:
    """Return a lag's answer to a cubic input: particular cubic's coefficients, C, e^{−h/τ}.

    The answer is b_0 + b_1 t + b_2 t² + b_3 t³ + C e^{−t/τ}; τ may be 0.
    """
    b3 = cubic[3]
    b2 = cubic[2] - 3 * tau * b3
    b1 = cubic[1] - 2 * tau * b2
    b0 = cubic[0] - tau * b1
    if tau == 0:
        return b0, b1, b2, b3, 0.0, 0.0
    return b0, b1, b2, b3, start - b0, np.exp(-step / tau)


@kernel
def _lag_end(
    lag: tuple[float, float, float, float, float, float], tau: float, step: float
) -> tuple[float, float, float]:
    """Return a lag's value after the step, and its first and second integral over it."""
    b0, b1, b2, b3, decay, factor = lag
    h = step
    value = b0 + h * (b1 + h * (b2 + h * b3)) + decay * factor
    faded = tau * (1 - factor)
    once = h * (b0 + h * (b1 / 2 + h * (b2 / 3 + h * b3 / 4))) + decay * faded
    twice = h * h * (b0 / 2 + h * (b1 / 6 + h * (b2 / 12 + h * b3 / 20)))
    return value, once, twice + decay * tau * (h - faded)


@kernel
def _hermite(
    start: float, slope_start: float, end: float, slope_end: float, step: float
) -> tuple[float, float, float, float]:
    """Return the coefficients of the cubic through two values with two slopes."""
    rise = (end - start) / step
    return (
        start,
        slope_start,
        (3 * rise - 2 * slope_start - slope_end) / step,
        (slope_start + slope_end - 2 * rise) / step**2,
    )


@kernel
def _cubic(coefficients: tuple[float, float, float, float], t: float) -> tuple[float, float]:
    """Return value and slope of a cubic."""
    c0, c1, c2, c3 = coefficients
    return c0 + t * (c1 + t * (c2 + t * c3)), c1 + t * (2 * c2 + t * 3 * c3)


@kernel
def _past(values: FloatArray, slopes: FloatArray, time: float, step: float) -> tuple[float, float]:
    """Return value and slope of a stored signal at an earlier time; rest before time 0."""
    if time <= 0:
        return 0.0, 0.0
    k = min(int(time / step), len(values) - 2)
    cubic = _hermite(values[k], slopes[k], values[k + 1], slopes[k + 1], step)
    return _cubic(cubic, time - k * step)


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
    for tap in range(6):
        value, rate = _past(y, dy, now - tap * sample, step)
        if tap == 0:
            value, rate = y[k], dy[k]
        weight = (5.0, 3.0, 1.0, -1.0, -3.0, -5.0)[tap] / (35 * sample)  # Eq. 23
        velocity += weight * value
        slope += weight * rate
    return velocity, slope


@kernel
def _command(
    gains: LoopGains,
    error: float,
    error_slope: float,
    lag1: float,
    lag2: float,
    integral: float,
    velocity_error: float,
    velocity_error_slope: float,
) -> tuple[float, float]:
    """Return F_ref = K_P,vel (v_ref + G_P (x_ref − x) − v) and its slope.

    Eq. 22 is written with e/(τs + 1) and e/(τs + 1)² as states.
    """
    corner = gains.tau * gains.omega
    lag1_slope, lag2_slope = (error - lag1) / gains.tau, (lag1 - lag2) / gains.tau
    damped = 2 * gains.xi / corner
    shape = (error - 2 * lag1 + lag2) / corner**2 + damped * (lag1 - lag2) + lag2
    shape_slope = (
        (error_slope - 2 * lag1_slope + lag2_slope) / corner**2
        + damped * (lag1_slope - lag2_slope)
        + lag2_slope
    )
    position = gains.k_p_pos * shape + gains.k_i_pos * integral  # Eq. 22
    position_slope = gains.k_p_pos * shape_slope + gains.k_i_pos * error
    force = gains.k_p_vel * (velocity_error + position)  # Eq. 18
    return force, gains.k_p_vel * (velocity_error_slope + position_slope)


@kernel
def _advance_controller(
    lag1: float,
    lag2: float,
    integral: float,
    error: tuple[float, float, float, float],
    tau: float,
    step: float,
) -> tuple[float, float, float]:
    """Return e/(τs + 1), e/(τs + 1)² and the integral of e after a step of a cubic error."""
    first = _lag(lag1, tau, error, step)
    cubic = (first[0], first[1], first[2], first[3])
    # The first lag's exponential drives the second at its own pole: C t/τ e^{−t/τ}.
    second = _lag_end(_lag(lag2, tau, cubic, step), tau, step)[0]
    second += first[4] * step / tau * first[5]
    c0, c1, c2, c3 = error
    gained = step * (c0 + step * (c1 / 2 + step * (c2 / 3 + step * c3 / 4)))
    return _lag_end(first, tau, step)[0], second, integral + gained


@kernel
def _response(
    plant: tuple[float, float, float, float, float],
    gains: LoopGains,
    path: MeasurementPath,
    time: FloatArray,
    pieces: FloatArray,
    levels: tuple[float, float, float],
    found: FloatArray,
) -> None:
    """Fill ``found`` ``(T, 2)`` with position and velocity of one plant."""
    mass, delay, tau_a, tau_b, share_a = plant
    load = levels[2]
    longest = _LONGEST_STEP if path.sample_time == 0 else min(_LONGEST_STEP, path.sample_time)
    behind = int(np.ceil(delay / longest))
    h = delay / behind
    steps = int(time[-1] / h) + 1
    force = np.zeros((steps, 4))  # F_ref over each step: start, slope, end, slope
    x, v, y, dy = np.zeros(steps + 1), np.zeros(steps + 1), np.zeros(steps + 1), np.zeros(steps + 1)
    side_a, side_b, lag1, lag2, integral = 0.0, 0.0, 0.0, 0.0, 0.0
    measured, measured_slope, out = 0.0, 0.0, 0
    for k in range(steps):
        past = (0.0, 0.0, 0.0, 0.0)
        if k >= behind:
            row = force[k - behind]
            past = _hermite(row[0], row[1], row[2], row[3], h)
        lag_a, lag_b = _lag(side_a, tau_a, past, h), _lag(side_b, tau_b, past, h)
        start = share_a * (lag_a[0] + lag_a[4]) + (1 - share_a) * (lag_b[0] + lag_b[4]) - load
        r, v_ref, a_ref = reference(k * h, pieces)
        error, error_slope = levels[1] + r - y[k], v_ref - dy[k]
        if path.sample_time == 0:
            measured, measured_slope = v[k], start / mass
        ahead = levels[0] + v_ref - measured
        force[k, 0], force[k, 1] = _command(
            gains, error, error_slope, lag1, lag2, integral, ahead, a_ref - measured_slope
        )

        side_a, once_a, twice_a = _lag_end(lag_a, tau_a, h)
        side_b, once_b, twice_b = _lag_end(lag_b, tau_b, h)
        end = share_a * side_a + (1 - share_a) * side_b - load
        once = share_a * once_a + (1 - share_a) * once_b - load * h
        twice = share_a * twice_a + (1 - share_a) * twice_b - load * h * h / 2
        v[k + 1] = v[k] + once / mass
        x[k + 1] = x[k] + h * v[k] + twice / mass
        if path.sample_time == 0:
            y[k + 1], dy[k + 1] = x[k + 1], v[k + 1]
            measured, measured_slope = v[k + 1], end / mass
        else:
            measured, measured_slope = _measured(k + 1, h, path, x, v, y, dy)

        r, v_ref, a_ref = reference((k + 1) * h, pieces)
        next_error, next_slope = levels[1] + r - y[k + 1], v_ref - dy[k + 1]
        errors = _hermite(error, error_slope, next_error, next_slope, h)
        lag1, lag2, integral = _advance_controller(lag1, lag2, integral, errors, gains.tau, h)
        ahead = levels[0] + v_ref - measured
        force[k, 2], force[k, 3] = _command(
            gains, next_error, next_slope, lag1, lag2, integral, ahead, a_ref - measured_slope
        )

        positions = _hermite(x[k], v[k], x[k + 1], v[k + 1], h)
        velocities = _hermite(v[k], start / mass, v[k + 1], end / mass, h)
        while out < len(time) and time[out] <= (k + 1) * h:
            found[out, 0] = _cubic(positions, time[out] - k * h)[0]
            found[out, 1] = _cubic(velocities, time[out] - k * h)[0]
            out += 1
    while out < len(time):
        found[out, 0], found[out, 1] = x[steps], v[steps]
        out += 1
