"""The supply pressures: accumulator, pump, tank line and converter cylinders (Fig. 1).

The lowest line is the tank side, the highest has the accumulator, or a constant pressure without
one; those between are constant or made by converters. Flow drawn from a converter's port moves its
piston, and a share α of that flow comes from one line, the rest from another, so that its pressure
stands at that share between the two. ``mptune.params.packed`` has the table of lines.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mptune.arrays import inlined_kernel, kernel
from mptune.plant.flow import orifice, orifice_slope

if TYPE_CHECKING:
    from mptune.params.packed import Machine

_FRICTION_FLOW = 2e-6  # m³/s: below it converter friction is proportional to flow
_ITERATIONS = 60
_ENOUGH = 0.1  # Pa, of a halving step
_NEWTON_ENOUGH = 10.0  # Pa, of a Newton step: the next would be well below 1 Pa


@inlined_kernel
def line_pressure(base: float, share: float, high: float) -> float:
    """Return the pressure of a line without friction [Pa], the highest line's being ``high``."""
    return base + share * (high - base)


@inlined_kernel
def accumulator_pressure(oil: float, machine: Machine) -> float:
    """Return p_HP [Pa] with ``oil`` [m³] in the accumulator; the gas is polytropic.

    Without an accumulator the state in its place is the pressure itself.
    """
    if machine.accumulator_volume <= 0:
        return oil
    gas = machine.accumulator_volume - max(oil, 0.0)
    compression: float = (machine.accumulator_volume / gas) ** machine.accumulator_exponent
    return machine.accumulator_precharge * compression


def oil_at_pressure(pressure: float, machine: Machine) -> float:
    """Return the oil in the accumulator [m³] at a pressure [Pa] above its precharge.

    Without an accumulator it is the pressure, as in ``accumulator_pressure``.
    """
    if machine.accumulator_volume <= 0:
        return pressure
    ratio = machine.accumulator_precharge / pressure
    return machine.accumulator_volume * (1 - math.pow(ratio, 1 / machine.accumulator_exponent))


@inlined_kernel
def port_pressure(
    ideal: float,
    open_a: float,
    open_b: float,
    pressure_a: float,
    pressure_b: float,
    blocked: int,
    machine: Machine,
) -> float:
    """Return the pressure at a converter's port [Pa].

    The port's net flow q, out of it into both chambers, rises with its pressure p, and friction
    lowers the pressure with the flow: p = ideal − friction(q), a monotone equation in p. A piston
    at its end (``blocked`` +1: it cannot fill further; −1: it cannot give more) lets no flow pass
    in that direction; the chambers then exchange through the port at the pressure where q = 0.

    Parameters
    ----------
    ideal
        Pressure without friction [Pa].
    open_a, open_b
        Open valves towards both chambers [K_v].
    pressure_a, pressure_b
        Chamber pressures [Pa].
    blocked
        0, or the end at which the piston stands.
    """
    scale, tr = machine.flow_coefficient, machine.transition_pressure
    free = _solved(
        ideal, open_a, open_b, pressure_a, pressure_b, machine.converter_friction, scale, tr
    )
    if blocked == 0:
        return free
    return _at_end(free, open_a, open_b, pressure_a, pressure_b, blocked, scale, tr)


@kernel
def _at_end(
    free: float,
    open_a: float,
    open_b: float,
    pressure_a: float,
    pressure_b: float,
    blocked: int,
    scale: float,
    tr: float,
) -> float:
    """Return the port's pressure with the piston at an end: rare, so it is kept out of line."""
    flow = _net_flow(free, open_a, open_b, pressure_a, pressure_b, scale, tr)
    if flow * blocked >= 0:
        return free
    return _solved(0.0, open_a, open_b, pressure_a, pressure_b, -1.0, scale, tr)


@inlined_kernel
def _net_flow(
    pressure: float,
    open_a: float,
    open_b: float,
    pressure_a: float,
    pressure_b: float,
    scale: float,
    tr: float,
) -> float:
    towards_a = open_a * orifice(pressure - pressure_a, tr)
    towards_b = open_b * orifice(pressure - pressure_b, tr)
    return scale * (towards_a + towards_b)


@inlined_kernel
def _solved(
    ideal: float,
    open_a: float,
    open_b: float,
    pressure_a: float,
    pressure_b: float,
    friction: float,
    scale: float,
    tr: float,
) -> float:
    """Solve p + friction · s(q(p)) = ideal, or q(p) = 0 where friction is negative.

    Newton's method inside a bracket that shrinks at every step, so that it cannot run away.
    """
    if friction >= 0:
        low, high = ideal - friction, ideal + friction
    else:
        low, high = min(pressure_a, pressure_b), max(pressure_a, pressure_b)
    # A first guess that is nearly right: the chambers' pressure where friction can hold it.
    both = open_a + open_b
    pressure = min(max((open_a * pressure_a + open_b * pressure_b) / both, low), high)
    last = 2 * (high - low) + _ENOUGH
    for _ in range(_ITERATIONS):
        to_a, to_b = pressure - pressure_a, pressure - pressure_b
        flow = scale * (open_a * orifice(to_a, tr) + open_b * orifice(to_b, tr))
        slope = scale * (open_a * orifice_slope(to_a, tr) + open_b * orifice_slope(to_b, tr))
        if friction >= 0:
            root = math.sqrt(flow * flow + _FRICTION_FLOW**2)
            excess = pressure - ideal + friction * flow / root
            slope = 1 + friction * slope * _FRICTION_FLOW**2 / root**3
        else:
            excess = flow
        if excess > 0:
            high = pressure
        else:
            low = pressure
        # Newton's step where it halves the one before and stays inside; else the middle.
        step = excess / slope
        enough = _NEWTON_ENOUGH
        if abs(step) > 0.5 * abs(last) or not low <= pressure - step <= high:
            step, enough = pressure - 0.5 * (low + high), _ENOUGH
        pressure -= step
        last = step
        if abs(step) < enough:
            break
    return pressure
