"""The whole machine as a differential equation: Eq. 1 to Eq. 4 with its supplies.

State, SI: piston position and velocity, chamber pressures A and B, oil in the accumulator,
converter positions; then the energies that the state has cost so far. Of all sizes only the two
chambers are compiled in: there are as many lines and converters as the table of lines has. More
chambers have a right-hand side of their own, ``mptune.plant.chambers``, and so have hoses as lines,
``mptune.plant.hoses``, made of the same parts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.arrays import FloatArray, inlined_kernel, kernel
from mptune.params.packed import (
    BASE,
    FROM_LOWEST,
    FROM_STEADY,
    MADE_BY,
    OPEN_A,
    OPEN_B,
    SHARE,
)
from mptune.plant.bulk import effective_bulk_modulus
from mptune.plant.flow import orifice
from mptune.plant.piston import Burden, friction
from mptune.plant.port import port_pressure
from mptune.plant.supplies import accumulator_pressure, line_pressure

if TYPE_CHECKING:
    from mptune.params.packed import Machine

X, V, PRESSURE_A, PRESSURE_B, OIL, CONVERTER = range(6)  # of the first converter
# Energies [J], all since the start; see ``powers``.
PUMP, ACCUMULATOR, TANK, PISTON, THROTTLING, CONVERTER_FRICTION, COMPRESSION, RELIEF = range(8)
ENERGIES = 8

_RELIEF_GRADIENT = 1e-9  # m³/(s Pa) above the relief pressure


@inlined_kernel
def states_of(machine: Machine) -> int:
    """Return the number of states S, those of hoses as lines not counted."""
    return CONVERTER + machine.converters


@kernel
def pressure_rate(pressure: float, rate: float) -> float:
    """Return the rate of a chamber's pressure; cavitation holds it at its floor of 0 Pa."""
    return 0.0 if pressure <= 0 and rate < 0 else rate


@inlined_kernel
def standing_at(place: float, machine: Machine) -> int:
    """Return the end at which a converter's piston stands, +1 full or −1 empty; 0 between them."""
    if abs(place) < machine.converter_travel:
        return 0
    return 1 if place > 0 else -1


@inlined_kernel
def valve_flow(scale: float, opened: float, difference: float, transition: float) -> float:
    """Return the flow through open valves [m³/s] at a pressure difference [Pa]."""
    return scale * opened * orifice(difference, transition)  # Eq. 2


@inlined_kernel
def rates(
    state: FloatArray,
    lines: FloatArray,
    pumping: float,
    machine: Machine,
    burden: Burden,
    slope: FloatArray,
    power: FloatArray,
    _chambers: FloatArray | None = None,
) -> None:
    """Fill ``slope`` ``(S,)`` with the state's time derivative and ``power`` ``(8,)`` with powers.

    Parameters
    ----------
    state
        ``(S,)``.
    lines
        ``(OPEN_ROWS, L)`` the lines that have an open valve, see ``mptune.params.packed``.
    pumping
        1 while the pump runs, else 0.
    machine
        Parameters.
    burden
        Load and inertia about the present position.
    """
    pressure_a, pressure_b = state[PRESSURE_A], state[PRESSURE_B]
    flow_a, flow_b = supply_flows(
        state, pressure_a, pressure_b, lines, pumping, machine, slope, power
    )
    chamber_rates(
        state, flow_a, flow_b, machine.hose_a, machine.hose_b, 0.0, machine, burden, slope, power
    )


@inlined_kernel
def supply_flows(
    state: FloatArray,
    pressure_a: float,
    pressure_b: float,
    lines: FloatArray,
    pumping: float,
    machine: Machine,
    slope: FloatArray,
    power: FloatArray,
) -> tuple[float, float]:
    """Return the flows out of all supplies towards A and B, at the pressures that valves see.

    The slopes of converters and accumulator are filled, and the powers of the supplies.
    """
    high = accumulator_pressure(state[OIL], machine)
    low, one_way = machine.low_pressure, machine.pump_lag > 0
    flow_a, flow_b, from_high, from_low, throttled, rubbed = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    given = 0.0  # W, of constant lines between the lowest and the highest
    for i in range(machine.converters):
        slope[CONVERTER + i] = 0.0
    load = 0.0  # Pa, that a pump follows
    for k in range(lines.shape[1]):
        open_a, open_b = lines[OPEN_A, k], lines[OPEN_B, k]
        if open_a == 0 and open_b == 0:
            break  # behind the last line that has an open valve
        pressure = line_pressure(lines[BASE, k], lines[SHARE, k], high)
        ideal = pressure
        converter = int(lines[MADE_BY, k])
        if converter >= 0:
            blocked = standing_at(state[CONVERTER + converter], machine)
            pressure = port_pressure(
                ideal, open_a, open_b, pressure_a, pressure_b, blocked, machine
            )
        to_a, to_b = pressure - pressure_a, pressure - pressure_b
        scale, tr = machine.flow_coefficient, machine.transition_pressure
        into_a = valve_flow(scale, open_a, to_a, tr)
        into_b = valve_flow(scale, open_b, to_b, tr)
        if one_way and lines[SHARE, k] == 1:
            into_a, into_b = max(into_a, 0.0), max(into_b, 0.0)
            load = max(pressure_a if open_a > 0 else 0.0, pressure_b if open_b > 0 else 0.0)
        drawn = into_a + into_b
        flow_a += into_a
        flow_b += into_b
        throttled += into_a * to_a + into_b * to_b
        from_high += lines[SHARE, k] * drawn
        from_low += lines[FROM_LOWEST, k] * drawn
        given += lines[FROM_STEADY, k] * drawn
        if converter >= 0:
            slope[CONVERTER + converter] = -drawn / machine.converter_area
            rubbed += (ideal - pressure) * drawn
    power[TANK] = low * from_low
    power[THROTTLING] = throttled
    power[CONVERTER_FRICTION] = rubbed
    feed(high, from_high, given, load, pumping, machine, slope, power)
    return flow_a, flow_b


@inlined_kernel
def feed(
    high: float,
    from_high: float,
    given: float,
    load: float,
    pumping: float,
    machine: Machine,
    slope: FloatArray,
    power: FloatArray,
) -> None:
    """Fill the slope of the highest line, and what accumulator and pump give.

    Parameters
    ----------
    high, from_high
        The line's pressure [Pa] and the flow out of it [m³/s].
    given
        Power of the constant lines between the lowest and the highest [W].
    load
        Pressure that a pump follows [Pa].
    pumping, machine
        As ``rates`` has them.
    slope, power
        Filled as far as said.
    """
    power[ACCUMULATOR] = high * from_high + given
    if machine.accumulator_volume > 0:
        pumped = pumping * machine.pump_flow
        relieved = max(high - machine.relief_pressure, 0.0) * _RELIEF_GRADIENT
        slope[OIL] = pumped - from_high - relieved
        power[PUMP] = high * pumped
        power[RELIEF] = high * relieved
    else:  # a line of constant pressure, or a pump that follows the load: it gives what is drawn
        slope[OIL] = 0.0
        if machine.pump_lag > 0:
            wanted = max(load + machine.pump_margin, machine.pump_standby)
            slope[OIL] = (min(wanted, machine.relief_pressure) - high) / machine.pump_lag
        power[PUMP] = power[ACCUMULATOR]
        power[RELIEF] = 0.0


@inlined_kernel
def chamber_rates(
    state: FloatArray,
    flow_a: float,
    flow_b: float,
    hose_a: float,
    hose_b: float,
    stored: float,
    machine: Machine,
    burden: Burden,
    slope: FloatArray,
    power: FloatArray,
) -> None:
    """Fill the slopes of chambers and piston, and their powers.

    ``hose_a`` and ``hose_b`` are the hose volumes that belong to the chambers [m³]; ``stored`` is
    the power that goes into lines [W].
    """
    x, v = state[X], state[V]
    pressure_a, pressure_b = state[PRESSURE_A], state[PRESSURE_B]
    volume_a = machine.area_a * x + machine.dead_a - (machine.hose_a - hose_a)
    away_b = machine.stroke - x
    volume_b = machine.area_b * away_b + machine.dead_b - (machine.hose_b - hose_b)
    squeezed_a = flow_a - machine.area_a * v
    squeezed_b = flow_b + machine.area_b * v
    slope[PRESSURE_A] = chamber_rate(pressure_a, volume_a, hose_a, squeezed_a, machine)
    slope[PRESSURE_B] = chamber_rate(pressure_b, volume_b, hose_b, squeezed_b, machine)
    force = machine.area_a * pressure_a - machine.area_b * pressure_b
    power[COMPRESSION] = pressure_a * squeezed_a + pressure_b * squeezed_b + stored
    drive(state, force, machine, burden, slope, power)


@inlined_kernel
def chamber_rate(
    pressure: float, volume: float, hose: float, squeezed: float, machine: Machine
) -> float:
    """Return the rate of a chamber's pressure [Pa/s].

    Parameters
    ----------
    pressure
        Its pressure [Pa].
    volume, hose
        Its whole volume, and that of the hose in it [m³].
    squeezed
        The flow into it less what the piston takes [m³/s].
    machine
        Oil and hose.
    """
    bulk = effective_bulk_modulus(machine.oil, machine.hose, hose, volume)
    return pressure_rate(pressure, bulk / volume * squeezed)  # Eq. 1, lines 1 and 2


@inlined_kernel
def drive(
    state: FloatArray,
    force: float,
    machine: Machine,
    burden: Burden,
    slope: FloatArray,
    power: FloatArray,
) -> None:
    """Fill the slopes of the piston under a force of its chambers [N], and its power."""
    x, v = state[X], state[V]
    away = x - burden.position
    # A boom's inertia varies with position; half its slope times v² acts like a force (Lagrange).
    opposed = burden.force + burden.stiffness * away + 0.5 * burden.mass_slope * v * v
    opposed += friction(v, machine)
    slope[X] = v
    slope[V] = (force - opposed) / (burden.mass + burden.mass_slope * away)  # Eq. 1, line 3
    power[PISTON] = force * v
