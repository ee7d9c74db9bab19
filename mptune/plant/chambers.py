"""The machine of Eq. 1 to Eq. 4 with any number of chambers on either side of its piston.

Its state is that of ``mptune.plant.machine``, the pressures of the first two chambers in their
usual places and those of the others behind everything else. Lines of this machine keep their
pressure or have the accumulator; converters, whose pressure hangs on all that is open to them, are
of machines with two chambers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.arrays import FloatArray, inlined_kernel, lending_kernel
from mptune.params.packed import (
    AREA,
    BASE,
    DEAD,
    FROM_LOWEST,
    FROM_STEADY,
    HOSE,
    LINE_ROWS,
    SHARE,
)
from mptune.plant.machine import (
    COMPRESSION,
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
    states_of,
    valve_flow,
)
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
    count = chambers.shape[1]
    for i in range(count):
        slope[place_of(i, machine)] = 0.0  # gathers the chamber's flow first
    for k in range(lines.shape[1]):
        pressure, drawn = line_pressure(lines[BASE, k], lines[SHARE, k], high), 0.0
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
    power[TANK] = machine.low_pressure * from_low
    power[THROTTLING] = throttled
    power[CONVERTER_FRICTION] = 0.0
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
