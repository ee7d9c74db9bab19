"""Attained values: the figure at one plant and frequency, and the way uphill from there.

Nothing here is rigorous, and nothing need be: the figure is taken from the loops as the rest of
mptune states them (the sampled loop whole), a route of its own beside the balls.
"""

from __future__ import annotations

import math

import numpy as np

from mptune.arrays import Complex, FloatArray, Real, kernel
from mptune.certify.enclosure import DELAY, GAIN, OMEGA, PHASE, RATIO, SIDES, TAU_A, TAU_B
from mptune.certify.form import COMPLIANCE, EQUATION_17, MIXTURE, Form
from mptune.loops.broken import SAMPLED, loop_around, position_loop, velocity_loop
from mptune.loops.position import position_error
from mptune.loops.sampled import coefficient_count, sampled_loop, sampled_plant
from mptune.loops.velocity import nominal_velocity, true_velocity, velocity_error
from mptune.params.packed import Plant

SINGULAR = 1e5  # a figure beyond it is taken for infinite
_LOWEST = 1e-5  # rad/s: the limit of vanishing frequency is taken there
_SHORTEST_STEP = 1e-7  # of a box's side
_GAIN = 1e-11  # relative: less is taken for rounding
_ROUNDS = 500
_IMMOVABLE = 1e300  # kg


@kernel
def gain_at(form: Form, point: FloatArray) -> Complex:
    """Return the loop gain that a mixture of S and T is made of, at a point ``(SIDES,)``."""
    return _gain_of(form, point, form.nominal.mass / point[RATIO])


@kernel
def _gain_of(form: Form, point: FloatArray, mass: float) -> Complex:
    s = complex(0.0, max(point[OMEGA], _LOWEST))
    plant = _plant(form, point)
    plant = Plant(mass, plant.delay, plant.tau_a, plant.tau_b, plant.share_a)
    gain = math.exp(point[GAIN])
    turn = complex(gain * math.cos(point[PHASE]), -gain * math.sin(point[PHASE]))
    if form.loop == SAMPLED:
        count = coefficient_count(plant.delay, form.path, form.period)
        sampled = sampled_plant(plant, form.path, form.period, count)
        return turn * sampled_loop(s, sampled, form.gains, form.period)
    velocity = true_velocity(s, plant)
    return loop_around(form.loop, s, turn * velocity, plant.mass, form.gains, form.path)


@kernel
def _plant(form: Form, point: FloatArray) -> Plant:
    """Return the plant at a point, as the loop as it runs has it no earlier than T_S/2."""
    delay = point[DELAY]
    if form.loop == SAMPLED:
        delay = max(delay, form.period / 2)
    mass = form.nominal.mass / point[RATIO]
    return Plant(mass, delay, point[TAU_A], point[TAU_B], form.share_a)


@kernel
def _ratio(form: Form, s: complex, point: FloatArray) -> Real:
    """Return the left over the right side of Eq. 17 or Eq. 21."""
    nominal = form.nominal
    velocity = nominal_velocity(s, nominal)
    inner = velocity_loop(s, velocity, form.gains.k_p_vel, form.path)
    error = velocity_error(s, _plant(form, point), nominal)
    if form.figure == EQUATION_17:
        return abs(error * inner / (1 + inner))  # Eq. 17
    outer = position_loop(s, velocity, form.gains, form.path)
    return abs(position_error(error, inner) * outer / (1 + outer))  # Eq. 21


@kernel
def allowed_at(curve: FloatArray, omega: float) -> Real:
    """Return the largest allowed ratio: linear over ln ω between the corners, else constant."""
    last = len(curve) - 1
    if last < 0:
        return 1.0
    if omega <= curve[0, 0]:
        return curve[0, 1]
    for k in range(last):
        if omega < curve[k + 1, 0]:
            share = math.log(omega / curve[k, 0]) / math.log(curve[k + 1, 0] / curve[k, 0])
            return curve[k, 1] + share * (curve[k + 1, 1] - curve[k, 1])
    return curve[last, 1]


@kernel
def figure_at(form: Form, curve: FloatArray, point: FloatArray) -> Real:
    """Return the figure at a point ``(SIDES,)`` of a box's coordinates."""
    omega = max(point[OMEGA], _LOWEST)
    if form.figure == MIXTURE:
        gain = gain_at(form, point)
        return abs((form.share_s + form.share_t * gain) / (1 + gain))
    if form.figure == COMPLIANCE:
        turn = omega * form.nominal.mass / form.gains.k_p_vel  # |P|
        soft = point[RATIO] / (turn * turn * abs(1 + gain_at(form, point)))
        if form.path.estimator_mass > 0:  # what it hears of the force is L of an infinite mass
            return soft * abs(1 + _gain_of(form, point, _IMMOVABLE))
        return soft
    return _ratio(form, complex(0.0, omega), point) / allowed_at(curve, omega)


@kernel
def _copy(source: FloatArray, target: FloatArray) -> None:
    for i in range(len(target)):
        target[i] = source[i]


@kernel
def climb(form: Form, curve: FloatArray, edges: FloatArray, point: FloatArray, step: float) -> Real:
    """Move a point to a local maximum of the figure within ``edges``, and return the figure there.

    Pattern search: each side is tried by ``step`` of its length both ways, a gain is repeated
    along the same diagonal, and the step halves where no side gains.
    """
    best = figure_at(form, curve, point)
    trial, base = np.empty(SIDES), np.empty(SIDES)
    for _ in range(_ROUNDS):
        if step < _SHORTEST_STEP or best > SINGULAR:
            break
        _copy(point, base)
        before = best
        for side in range(2 * SIDES):
            i = side // 2
            length = step * (edges[1, i] - edges[0, i])
            if i == OMEGA:  # at low frequency finer than at high
                length = min(length, step * (0.5 * point[i] + 1e-3 * edges[1, i]))
            _copy(point, trial)
            trial[i] += length if side % 2 == 0 else -length
            best = _better(form, curve, edges, trial, point, best)
        if best == before:
            step *= 0.5
            continue
        for i in range(SIDES):
            trial[i] = 2 * point[i] - base[i]
        best = _better(form, curve, edges, trial, point, best)
    return best


@kernel
def _better(
    form: Form,
    curve: FloatArray,
    edges: FloatArray,
    trial: FloatArray,
    point: FloatArray,
    best: float,
) -> Real:
    """Move the point to the trial, brought within the edges, where the figure gains by that."""
    moved = False
    for i in range(SIDES):
        trial[i] = min(max(trial[i], edges[0, i]), edges[1, i])
        moved = moved or trial[i] != point[i]
    if not moved:
        return best
    value = figure_at(form, curve, trial)
    if value > best * (1 + _GAIN):
        _copy(trial, point)
        return value
    return best


@kernel
def explore(
    form: Form,
    curve: FloatArray,
    edges: FloatArray,
    omega: FloatArray,
    plants: FloatArray,
    climbs: int,
    step: float,
    point: FloatArray,
) -> float:
    """Return a high value of the figure within a box, and where.

    Parameters
    ----------
    form, curve
        The figure.
    edges
        ``(2, SIDES)``: the box.
    omega
        ``(F,)``: every plant is tried at all of these [rad/s].
    plants
        ``(P, SIDES)``: the plants that are tried; filled with the best frequency of each.
    climbs
        From so many of them, the best, the figure is followed uphill.
    step
        First step of the climbs, of the box's sides.
    point
        ``(SIDES,)``, filled: where the value is attained.
    """
    heights, trial = np.empty(len(plants)), np.empty(SIDES)
    for n in range(len(plants)):
        heights[n] = -1.0
        _copy(plants[n], trial)
        for f in range(len(omega)):
            trial[OMEGA] = omega[f]
            value = figure_at(form, curve, trial)
            if value > heights[n]:
                heights[n] = value
                plants[n, OMEGA] = omega[f]
    best = -1.0
    for _ in range(min(climbs, len(plants))):
        n = int(np.argmax(heights))
        heights[n] = -2.0
        _copy(plants[n], trial)
        value = climb(form, curve, edges, trial, step)
        if value > best:
            best = value
            _copy(trial, point)
    return best
