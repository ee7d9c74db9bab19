"""Fig. 2's simulation model: the force controller on the chambers, all else held still.

The piston moves at a given velocity, yet its position stays where it is: volumes and stiffness are
those of the operating point, and a real stroke would run out. Supplies and converters are frozen as
well, so that each chamber is one equation in its own pressure. It is integrated by the classical
Runge-Kutta method, in whole steps between the instants at which valves switch.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, IntArray, kernel
from mptune.force.chambers import decide_of_chambers
from mptune.force.select import decide
from mptune.params.packed import AREA, CHAMBER_ROWS, DEAD, HOSE, SIZE
from mptune.plant.bulk import effective_bulk_modulus
from mptune.plant.flow import orifice
from mptune.signals.conditioning import median_of_three

if TYPE_CHECKING:
    from mptune.force.search_space import SearchSpace
    from mptune.params.packed import ForceSettings, Machine, MoreChambers

STEPS = 4  # of the integration in one tick of T_S,fast


class Chambers(NamedTuple):
    """The chambers of a piston that is held in place, moving as it were."""

    position: float  # m
    velocity: float  # m/s
    areas: FloatArray  # (C,) m², positive where pressure pushes the piston out
    stiffness: FloatArray  # (C,) Pa/m³, B_eff over volume
    valves: FloatArray  # (C,) -, size of each chamber's valves, in those of the edges


class Loop(NamedTuple):
    """What lies between the chambers and the force controller."""

    tick: float  # s, T_S,fast
    ticks: int  # in one sampling period
    delay: float  # s, of the valves; shorter than a sampling period
    pole: float  # of the pressure filter at T_S,fast
    filtered: bool  # whether pressures are seen through median and filter


def chambers_at(
    machine: Machine, position: float, velocity: float, more: MoreChambers | None = None
) -> Chambers:
    """Return the chambers of a machine with its piston at ``position`` [m]."""
    table = _two_chambers(machine) if more is None else more.table
    area, dead, hose = table[AREA], table[DEAD], table[HOSE]
    volume = np.abs(area) * np.where(area > 0, position, machine.stroke - position) + dead
    bulk = effective_bulk_modulus(machine.oil, machine.hose, hose, volume)
    return Chambers(position, velocity, area, np.asarray(bulk / volume), table[SIZE])


def _two_chambers(machine: Machine) -> FloatArray:
    """Return the table of a machine's two chambers ``(CHAMBER_ROWS, 2)``."""
    table = np.ones((CHAMBER_ROWS, 2))
    table[AREA] = machine.area_a, -machine.area_b
    table[DEAD] = machine.dead_a, machine.dead_b
    table[HOSE] = machine.hose_a, machine.hose_b
    return table


@kernel
def run_force_loop(
    reference: FloatArray,
    start: FloatArray,
    chambers: Chambers,
    loop: Loop,
    supplies: FloatArray,
    space: SearchSpace,
    settings: ForceSettings,
    pressures: FloatArray,
    more: MoreChambers | None = None,
) -> None:
    """Run the force loop and fill ``pressures`` ``(C, T)`` of the chambers at each tick [Pa].

    Parameters
    ----------
    reference
        ``(T,)`` F_ref at each tick [N]; the controller reads it once in a sampling period.
    start
        ``(C,)`` pressures at the start [Pa], valves shut.
    chambers, loop
        The operating point, and delay and filters.
    supplies
        ``(L,)`` pressures of the lines [Pa].
    space, settings
        Search space and the controller's knowledge.
    more
        The chambers where there are more than two.
    """
    count = len(start)
    converters = np.zeros(space.lines.shape[1])  # all at their centres
    present, seen, raw = start.copy(), start.copy(), np.empty((2, count))
    raw[0], raw[1] = start, start
    chosen, states = np.zeros(count, np.int64), np.zeros(count, np.int64)
    whole = int(loop.delay / loop.tick + 1e-9)
    within = max(loop.delay - whole * loop.tick, 0.0)  # of a tick, where the valves switch
    for tick in range(len(reference)):
        pressures[:, tick] = present
        _measure(present, loop, raw, seen)
        if tick % loop.ticks == 0:
            if more is not None:
                decide_of_chambers(
                    reference[tick], seen, chambers.position, chambers.velocity, supplies,
                    converters, chosen, space, more,
                )  # fmt: skip
            else:
                chosen[0], chosen[1] = decide(
                    reference[tick], seen[0], seen[1], chambers.position, chambers.velocity,
                    supplies, converters, chosen[0], chosen[1], space, settings,
                )  # fmt: skip
        span = loop.tick
        if tick % loop.ticks == whole:
            if within > 0:
                _advance(present, states, chambers, supplies, within, space, settings)
            span -= within
            states[:] = chosen
        _advance(present, states, chambers, supplies, span, space, settings)


@kernel
def _measure(present: FloatArray, loop: Loop, raw: FloatArray, seen: FloatArray) -> None:
    """Sample the pressures; take the median of three and filter, where the loop has filters."""
    for i in range(len(present)):
        sample = present[i]
        if not loop.filtered:
            seen[i] = sample
            continue
        middle = median_of_three(sample, raw[0, i], raw[1, i])
        raw[1, i], raw[0, i] = raw[0, i], sample
        seen[i] = loop.pole * seen[i] + (1 - loop.pole) * middle


@kernel
def _advance(
    present: FloatArray,
    states: IntArray,
    chambers: Chambers,
    supplies: FloatArray,
    span: float,
    space: SearchSpace,
    settings: ForceSettings,
) -> None:
    """Carry the chambers' pressures on by ``span`` [s] with their valve states held."""
    for i in range(len(present)):
        # The flow that the piston's motion leaves room for, negative where it takes it [m³/s].
        into = -chambers.areas[i] * chambers.velocity
        scale = settings.flow_coefficient * chambers.valves[i]
        present[i] = _carried(
            present[i], chambers.stiffness[i], into, states[i], supplies, span, space, scale,
            settings.transition_pressure,
        )  # fmt: skip


@kernel
def _carried(
    pressure: float,
    stiffness: float,
    into: float,
    state: int,
    supplies: FloatArray,
    span: float,
    space: SearchSpace,
    scale: float,
    tr: float,
) -> float:
    """Return a chamber's pressure after ``span`` [s] [Pa]; ``scale`` is of its valves' size."""
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
