"""Fig. 2's simulation model: the force controller on two chambers, all else held still.

The piston moves at a given velocity, yet its position stays where it is: volumes and stiffness are
those of the operating point, and a real stroke would run out. Supplies and converters are frozen as
well, so that each chamber is one equation in its own pressure. It is integrated by the classical
Runge-Kutta method, in whole steps between the instants at which valves switch.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, kernel
from mptune.force.select import decide
from mptune.plant.bulk import effective_bulk_modulus
from mptune.plant.flow import orifice
from mptune.signals.conditioning import median_of_three

if TYPE_CHECKING:
    from mptune.force.search_space import SearchSpace
    from mptune.params.packed import ForceSettings, Machine

STEPS = 4  # of the integration in one tick of T_S,fast


class Chambers(NamedTuple):
    """Both chambers of a piston that is held in place, moving as it were."""

    position: float  # m
    velocity: float  # m/s
    area_a: float  # m²
    area_b: float
    stiffness_a: float  # Pa/m³, B_eff over volume
    stiffness_b: float


class Loop(NamedTuple):
    """What lies between the chambers and the force controller."""

    tick: float  # s, T_S,fast
    ticks: int  # in one sampling period
    delay: float  # s, of the valves; shorter than a sampling period
    pole: float  # of the pressure filter at T_S,fast
    filtered: bool  # whether pressures are seen through median and filter


def chambers_at(machine: Machine, position: float, velocity: float) -> Chambers:
    """Return the chambers of a machine with its piston at ``position`` [m]."""
    volume_a = machine.area_a * position + machine.dead_a
    volume_b = machine.area_b * (machine.stroke - position) + machine.dead_b
    bulk_a = effective_bulk_modulus(machine.oil, machine.hose, machine.hose_a, volume_a)
    bulk_b = effective_bulk_modulus(machine.oil, machine.hose, machine.hose_b, volume_b)
    return Chambers(
        position=position,
        velocity=velocity,
        area_a=machine.area_a,
        area_b=machine.area_b,
        stiffness_a=bulk_a / volume_a,
        stiffness_b=bulk_b / volume_b,
    )


@kernel
def run_force_loop(
    reference: FloatArray,
    pressure_a: float,
    pressure_b: float,
    chambers: Chambers,
    loop: Loop,
    supplies: FloatArray,
    space: SearchSpace,
    settings: ForceSettings,
    pressures: FloatArray,
) -> None:
    """Run the force loop and fill ``pressures`` ``(2, T)`` of A and B at each tick [Pa].

    Parameters
    ----------
    reference
        ``(T,)`` F_ref at each tick [N]; the controller reads it once in a sampling period.
    pressure_a, pressure_b
        At the start [Pa], valves shut.
    chambers, loop
        The operating point, and delay and filters.
    supplies
        ``(L,)`` pressures of the lines [Pa].
    space, settings
        Search space and the controller's knowledge.
    """
    converters = np.zeros(space.lines.shape[1])  # all at their centres
    seen = np.array([pressure_a, pressure_b])
    raw = np.array([[pressure_a, pressure_b], [pressure_a, pressure_b]])
    chosen_a, chosen_b, state_a, state_b = 0, 0, 0, 0
    into_a = -chambers.area_a * chambers.velocity
    into_b = chambers.area_b * chambers.velocity
    whole = int(loop.delay / loop.tick + 1e-9)
    within = max(loop.delay - whole * loop.tick, 0.0)  # of a tick, where the valves switch
    for tick in range(len(reference)):
        pressures[0, tick], pressures[1, tick] = pressure_a, pressure_b
        _measure(pressure_a, pressure_b, loop, raw, seen)
        if tick % loop.ticks == 0:
            chosen_a, chosen_b = decide(
                reference[tick], seen[0], seen[1], chambers.position, chambers.velocity,
                supplies, converters, chosen_a, chosen_b, space, settings,
            )  # fmt: skip
        span = loop.tick
        if tick % loop.ticks == whole:
            if within > 0:
                pressure_a = _advance(
                    pressure_a, chambers.stiffness_a, into_a, state_a, supplies, within, space,
                    settings,
                )  # fmt: skip
                pressure_b = _advance(
                    pressure_b, chambers.stiffness_b, into_b, state_b, supplies, within, space,
                    settings,
                )  # fmt: skip
            span -= within
            state_a, state_b = chosen_a, chosen_b
        pressure_a = _advance(
            pressure_a, chambers.stiffness_a, into_a, state_a, supplies, span, space, settings
        )
        pressure_b = _advance(
            pressure_b, chambers.stiffness_b, into_b, state_b, supplies, span, space, settings
        )


@kernel
def _measure(
    pressure_a: float, pressure_b: float, loop: Loop, raw: FloatArray, seen: FloatArray
) -> None:
    """Sample both pressures; take the median of three and filter, where the loop has filters."""
    for side in range(2):
        sample = pressure_a if side == 0 else pressure_b
        if not loop.filtered:
            seen[side] = sample
            continue
        middle = median_of_three(sample, raw[0, side], raw[1, side])
        raw[1, side], raw[0, side] = raw[0, side], sample
        seen[side] = loop.pole * seen[side] + (1 - loop.pole) * middle


@kernel
def _advance(
    pressure: float,
    stiffness: float,
    into: float,
    state: int,
    supplies: FloatArray,
    span: float,
    space: SearchSpace,
    settings: ForceSettings,
) -> float:
    """Return a chamber's pressure after ``span`` [s] with a valve state held [Pa].

    ``into`` is the flow that the piston's motion leaves room for, negative where it takes it
    [m³/s].
    """
    scale, tr = settings.flow_coefficient, settings.transition_pressure
    first, second = supplies[space.first[state]], supplies[space.second[state]]
    count_1 = scale * space.first_count[state]
    count_2 = scale * space.second_count[state]
    h = span / STEPS
    for _ in range(STEPS):
        k1 = _rate(pressure, stiffness, into, first, count_1, second, count_2, tr)
        ahead = pressure + 0.5 * h * k1
        k2 = _rate(ahead, stiffness, into, first, count_1, second, count_2, tr)
        ahead = pressure + 0.5 * h * k2
        k3 = _rate(ahead, stiffness, into, first, count_1, second, count_2, tr)
        ahead = pressure + h * k3
        k4 = _rate(ahead, stiffness, into, first, count_1, second, count_2, tr)
        pressure += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        pressure = max(pressure, 0.0)  # cavitation
    return pressure


@kernel
def _rate(
    pressure: float,
    stiffness: float,
    into: float,
    first: float,
    count_1: float,
    second: float,
    count_2: float,
    transition: float,
) -> float:
    flow = count_1 * orifice(first - pressure, transition)  # Eq. 2
    if count_2 > 0:
        flow += count_2 * orifice(second - pressure, transition)
    return stiffness * (flow + into)  # Eq. 1, lines 1 and 2
