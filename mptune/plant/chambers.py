"""The machine of Eq. 1 to Eq. 4 with any number of chambers on either side of its piston.

Its state is that of ``mptune.plant.machine``, the pressures of the first two chambers in their
usual places and those of the others behind everything else.
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
    LINE_ROWS,
    MADE_BY,
    SHARE,
)
from mptune.plant.flow import orifice, orifice_slope
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
            difference = pressure - to.state[place_of(i, to.machine)]
            flow += opened * orifice(difference, tr)
            slope += opened * orifice_slope(difference, tr)
    return scale * flow, scale * slope


@inlined_kernel
def _around_all(to: Open) -> tuple[float, float, float]:
    valves, weighed, least, largest = 0.0, 0.0, math.inf, 0.0
    for i in range(to.chambers.shape[1]):
        opened = to.lines[LINE_ROWS + i, to.line]
        if opened > 0:
            pressure = to.state[place_of(i, to.machine)]
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
        slope[place_of(i, machine)] = 0.0  # gathers the chamber's flow first
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
            within = state[place_of(i, machine)]
            into = valve_flow(scale, opened, pressure - within, tr)
            if one_way and lines[SHARE, k] == 1:
                into, load = max(into, 0.0), max(load, within)
            slope[place_of(i, machine)] += into
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
        squeezed = slope[place] - area * state[V]
        slope[place] = chamber_rate(state[place], volume, hose, squeezed, machine)
        stored += state[place] * squeezed
    power[COMPRESSION] = stored
    drive(state, chambers_force(state, machine, chambers), machine, burden, slope, power)
