"""The machine of Eq. 1 to Eq. 4 with any number of chambers on either side of its piston.

Its state is that of ``mptune.plant.machine``, the pressures of the first two chambers in their
usual places and those of the others behind everything else. With hoses as lines the pressures at
the valves' end of every chamber's hose follow, then the flows towards the chambers; a chamber
without a hose has its valves at itself, and its places stand idle.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from mptune.arrays import FloatArray, inlined_kernel, lending_kernel
from mptune.params.packed import (
    AREA,
    BASE,
    DEAD,
    FROM_LOWEST,
    FROM_STEADY,
    HOSE,
    INERTANCE,
    LINE_ROWS,
    MADE_BY,
    RESISTANCE,
    SHARE,
)
from mptune.plant.flow import orifice, orifice_slope
from mptune.plant.hoses import hose_rates
from mptune.plant.machine import (
    COMPRESSION,
    CONVERTER,
    CONVERTER_FRICTION,
    OIL,
    PRESSURE_A,
    TANK,
    THROTTLING,
    V,
    X,
    chamber_rate,
    drive,
    feed,
    standing_at,
    states_of,
    valve_flow,
)
from mptune.plant.port import port_law
from mptune.plant.supplies import accumulator_pressure, line_pressure

if TYPE_CHECKING:
    from mptune.params.packed import Machine
    from mptune.plant.piston import Burden

_OF_ALL = 2  # chambers that stand where every machine's do


@inlined_kernel
def place_of(chamber: int, machine: Machine) -> int:
    """Return where in the state the pressure of a chamber stands."""
    if chamber < _OF_ALL:
        return PRESSURE_A + chamber
    return states_of(machine) + chamber - _OF_ALL


@inlined_kernel
def valve_end_of(chamber: int, chambers: int, machine: Machine) -> int:
    """Return where the pressure stands at the valves' end of a hose, of so many chambers."""
    return states_of(machine) + chambers - _OF_ALL + chamber


@inlined_kernel
def seen_at(chamber: int, machine: Machine, chambers: FloatArray) -> int:
    """Return where the pressure stands that a chamber's valves see."""
    if chambers[INERTANCE, chamber] > 0:
        return valve_end_of(chamber, chambers.shape[1], machine)
    return place_of(chamber, machine)


@inlined_kernel
def further_states(chambers: FloatArray) -> tuple[int, int]:
    """Return how many states there are behind the machine's own, and how many are pressures."""
    count, lined = chambers.shape[1], False
    for i in range(count):
        lined = lined or chambers[INERTANCE, i] > 0
    if lined:
        return 3 * count - _OF_ALL, 2 * count - _OF_ALL
    return count - _OF_ALL, count - _OF_ALL


@lending_kernel
def chambers_force(state: FloatArray, machine: Machine, chambers: FloatArray) -> float:
    """Return the force of all chambers on the piston [N]."""
    force = 0.0
    for i in range(chambers.shape[1]):
        force += chambers[AREA, i] * state[place_of(i, machine)]
    return force


class Open(NamedTuple):
    """What is open to one line: a column of the table of lines, and the state."""

    lines: FloatArray  # (LINE_ROWS + C, L)
    line: int
    state: FloatArray
    chambers: FloatArray  # (CHAMBER_ROWS, C)
    machine: Machine


@inlined_kernel
def _flow_to_all(pressure: float, to: Open, scale: float, tr: float) -> tuple[float, float]:
    flow, slope = 0.0, 0.0
    for i in range(to.chambers.shape[1]):
        opened = to.lines[LINE_ROWS + i, to.line]
        if opened > 0:
            difference = pressure - to.state[seen_at(i, to.machine, to.chambers)]
            flow += opened * orifice(difference, tr)
            slope += opened * orifice_slope(difference, tr)
    return scale * flow, scale * slope


@inlined_kernel
def _around_all(to: Open) -> tuple[float, float, float]:
    valves, weighed, least, largest = 0.0, 0.0, math.inf, 0.0
    for i in range(to.chambers.shape[1]):
        opened = to.lines[LINE_ROWS + i, to.line]
        if opened > 0:
            pressure = to.state[seen_at(i, to.machine, to.chambers)]
            valves, weighed = valves + opened, weighed + opened * pressure
            least, largest = min(least, pressure), max(largest, pressure)
    return weighed / valves, least, largest


_port_of_all = port_law(_flow_to_all, _around_all)


@inlined_kernel
def _port_of_line(ideal: float, converter: int, to: Open) -> float:
    """Return the pressure at the port of the converter that makes a line [Pa]."""
    any_open = False
    for i in range(to.chambers.shape[1]):
        any_open = any_open or to.lines[LINE_ROWS + i, to.line] > 0
    if not any_open:
        return ideal
    blocked = standing_at(to.state[CONVERTER + converter], to.machine)
    pressure: float = _port_of_all(ideal, to, blocked, to.machine)
    return pressure


@lending_kernel
def rates_of_chambers(
    state: FloatArray,
    lines: FloatArray,
    pumping: float,
    machine: Machine,
    burden: Burden,
    slope: FloatArray,
    power: FloatArray,
    chambers: FloatArray,
) -> None:
    """Do what ``mptune.plant.machine.rates`` does for all of ``chambers`` ``(CHAMBER_ROWS, C)``.

    Of ``lines`` each chamber has a row of its own, see ``mptune.plant.chamber_valves``.
    """
    high, one_way = accumulator_pressure(state[OIL], machine), machine.pump_lag > 0
    scale, tr = machine.flow_coefficient, machine.transition_pressure
    from_high, from_low, given, throttled, load = 0.0, 0.0, 0.0, 0.0, 0.0
    rubbed, count = 0.0, chambers.shape[1]
    for i in range(count):
        slope[seen_at(i, machine, chambers)] = 0.0  # gathers the flow out of the valves first
    for k in range(lines.shape[1]):
        ideal, drawn = line_pressure(lines[BASE, k], lines[SHARE, k], high), 0.0
        pressure, converter = ideal, int(lines[MADE_BY, k])
        if converter >= 0:
            to = Open(lines, k, state, chambers, machine)
            pressure = _port_of_line(ideal, converter, to)
        for i in range(count):
            opened = lines[LINE_ROWS + i, k]
            if opened == 0:
                continue
            seen = seen_at(i, machine, chambers)
            within = state[seen]
            into = valve_flow(scale, opened, pressure - within, tr)
            if one_way and lines[SHARE, k] == 1:
                into, load = max(into, 0.0), max(load, within)
            slope[seen] += into
            throttled += into * (pressure - within)
            drawn += into
        from_high += lines[SHARE, k] * drawn
        from_low += lines[FROM_LOWEST, k] * drawn
        given += lines[FROM_STEADY, k] * drawn
        if converter >= 0:
            slope[CONVERTER + converter] = -drawn / machine.converter_area
            rubbed += (ideal - pressure) * drawn
    power[TANK] = machine.low_pressure * from_low
    power[THROTTLING] = throttled
    power[CONVERTER_FRICTION] = rubbed
    feed(high, from_high, given, load, pumping, machine, slope, power)
    stored = 0.0
    for i in range(count):
        place, area, hose = place_of(i, machine), chambers[AREA, i], chambers[HOSE, i]
        away = state[X] if area > 0 else machine.stroke - state[X]
        volume = abs(area) * away + chambers[DEAD, i]
        seen = seen_at(i, machine, chambers)
        into = slope[seen]
        if seen != place:  # the hose is a line of its own
            along = state[seen + count]
            slope[seen], slope[seen + count], gained = hose_rates(
                state[seen], state[place], into, along, hose, chambers[INERTANCE, i],
                chambers[RESISTANCE, i], machine,
            )  # fmt: skip
            stored += gained
            into, volume, hose = along, volume - hose, 0.0
        squeezed = into - area * state[V]
        slope[place] = chamber_rate(state[place], volume, hose, squeezed, machine)
        stored += state[place] * squeezed
    power[COMPRESSION] = stored
    drive(state, chambers_force(state, machine, chambers), machine, burden, slope, power)
