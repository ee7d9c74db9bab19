"""The pressure at a converter cylinder's port (Fig. 1), which hangs on all that is open to it.

The port's net flow q, out of it into the chambers, rises with its pressure p, and friction lowers
the pressure with the flow: p = ideal − friction(q), a monotone equation in p. A piston at its end
lets no flow pass in one direction; the chambers then exchange through the port at the pressure
where q = 0. The equation is solved here alone; what is open to the port is read by kernels of its
own, for two chambers from plain numbers, which is faster, and for more of them from tables.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from mptune.arrays import inlined_kernel, kernel
from mptune.plant.flow import orifice, orifice_slope

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.params.packed import Machine

_FRICTION_FLOW = 2e-6  # m³/s: below it converter friction is proportional to flow
_ITERATIONS = 60
_ENOUGH = 0.1  # Pa, of a halving step
_NEWTON_ENOUGH = 10.0  # Pa, of a Newton step: the next would be well below 1 Pa


def _solver(flow_and_slope: Callable[..., tuple[float, float]]) -> Callable[..., float]:
    """Return the kernel that solves for a port's pressure, see ``port_law``."""

    @inlined_kernel
    def solved(
        ideal: float,
        friction: float,
        guess: float,
        low: float,
        high: float,
        opened: Any,  # whatever ``flow_and_slope`` reads
        scale: float,
        tr: float,
    ) -> float:
        """Solve p + friction · s(q(p)) = ideal, or q(p) = 0 where friction is negative.

        Newton's method inside a bracket that shrinks at every step, so that it cannot run away.
        """
        pressure = min(max(guess, low), high)
        last = 2 * (high - low) + _ENOUGH
        for _ in range(_ITERATIONS):
            flow, slope = flow_and_slope(pressure, opened, scale, tr)
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

    return solved


def port_law(
    flow_and_slope: Callable[..., tuple[float, float]],
    around: Callable[..., tuple[float, float, float]],
) -> Callable[..., float]:
    """Return the kernel that solves a port's equation, for a way to say what is open to it.

    Parameters
    ----------
    flow_and_slope
        Gives the net flow [m³/s] out of the port at a pressure, and its slope [m³/(s Pa)], from
        the pressure, what is open, K_v of one valve and the transition pressure.
    around
        Gives the chambers' pressure, the mean by open valves, the least and the largest [Pa].

    Returns
    -------
    callable
        Gives the port's pressure [Pa] from its pressure without friction, what is open, 0 or the
        end at which the piston stands (+1: it cannot fill further; −1: it cannot give more), and
        the machine.
    """
    solved = _solver(flow_and_slope)

    @kernel
    def at_end(
        free: float,
        opened: Any,
        blocked: int,
        scale: float,
        tr: float,
    ) -> float:
        """Return the pressure with the piston at an end: rare, so it is kept out of line."""
        flow, _ = flow_and_slope(free, opened, scale, tr)
        if flow * blocked >= 0:
            return free
        guess, least, largest = around(opened)
        held: float = solved(0.0, -1.0, guess, least, largest, opened, scale, tr)
        return held

    @inlined_kernel
    def pressure_at(
        ideal: float,
        opened: Any,
        blocked: int,
        machine: Machine,
    ) -> float:
        scale, tr = machine.flow_coefficient, machine.transition_pressure
        friction = machine.converter_friction
        # A first guess that is nearly right: the chambers' pressure where friction can hold it.
        guess, _, _ = around(opened)
        low, high = ideal - friction, ideal + friction
        free: float = solved(ideal, friction, guess, low, high, opened, scale, tr)
        if blocked == 0:
            return free
        return at_end(free, opened, blocked, scale, tr)

    return pressure_at


@inlined_kernel
def _flow_to_two(
    pressure: float, opened: tuple[float, float, float, float], scale: float, tr: float
) -> tuple[float, float]:
    open_a, open_b, pressure_a, pressure_b = opened
    to_a, to_b = pressure - pressure_a, pressure - pressure_b
    flow = scale * (open_a * orifice(to_a, tr) + open_b * orifice(to_b, tr))
    slope = scale * (open_a * orifice_slope(to_a, tr) + open_b * orifice_slope(to_b, tr))
    return flow, slope


@inlined_kernel
def _around_two(opened: tuple[float, float, float, float]) -> tuple[float, float, float]:
    open_a, open_b, pressure_a, pressure_b = opened
    mean = (open_a * pressure_a + open_b * pressure_b) / (open_a + open_b)
    return mean, min(pressure_a, pressure_b), max(pressure_a, pressure_b)


_of_two = port_law(_flow_to_two, _around_two)


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
    """Return the pressure at a converter's port between two chambers [Pa].

    Parameters
    ----------
    ideal
        Pressure without friction [Pa].
    open_a, open_b
        Open valves towards both chambers [K_v].
    pressure_a, pressure_b
        Chamber pressures [Pa].
    blocked
        0, or the end at which the piston stands: +1, it cannot fill further; −1, it cannot give
        more.
    machine
        The machine.
    """
    return _of_two(ideal, (open_a, open_b, pressure_a, pressure_b), blocked, machine)
