"""Hoses as lines: each a volume at the valves' end and one lump of oil with inertia and friction.

A machine of two chambers with them has a right-hand side of its own, which leaves the usual one,
the paper's, as fast as it is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.arrays import FloatArray, inlined_kernel, kernel
from mptune.plant.machine import (
    PRESSURE_A,
    PRESSURE_B,
    chamber_rates,
    pressure_rate,
    states_of,
    supply_flows,
)

if TYPE_CHECKING:
    from mptune.params.packed import Machine
    from mptune.plant.piston import Burden

# Behind the converters: pressures at the valves' end, and flows towards the chambers.
VALVE_END_A, VALVE_END_B, LINE_A, LINE_B = range(4)
LINE_STATES = 4


@kernel
def rates_with_lines(
    state: FloatArray,
    lines: FloatArray,
    pumping: float,
    machine: Machine,
    burden: Burden,
    slope: FloatArray,
    power: FloatArray,
    _chambers: FloatArray | None = None,
) -> None:
    """Do what ``rates`` does for the ``(S + 4,)`` states of a machine with hoses as lines.

    Each hose is a volume at the valves' end and one lump of oil with inertia and laminar friction.
    """
    own = states_of(machine)
    end_a, end_b = state[own + VALVE_END_A], state[own + VALVE_END_B]
    line_a, line_b = state[own + LINE_A], state[own + LINE_B]
    flow_a, flow_b = supply_flows(state, end_a, end_b, lines, pumping, machine, slope, power)
    slope[own + VALVE_END_A], slope[own + LINE_A], stored_a = hose_rates(
        end_a, state[PRESSURE_A], flow_a, line_a, machine.hose_a, machine.line_inertance,
        machine.line_resistance, machine,
    )  # fmt: skip
    slope[own + VALVE_END_B], slope[own + LINE_B], stored_b = hose_rates(
        end_b, state[PRESSURE_B], flow_b, line_b, machine.hose_b, machine.line_inertance_b,
        machine.line_resistance_b, machine,
    )  # fmt: skip
    stored = stored_a + stored_b
    chamber_rates(state, line_a, line_b, 0.0, 0.0, stored, machine, burden, slope, power)


@inlined_kernel
def hose_rates(
    end: float,
    within: float,
    into: float,
    along: float,
    hose: float,
    inertance: float,
    resistance: float,
    machine: Machine,
) -> tuple[float, float, float]:
    """Return a hose's rates of pressure and flow [Pa/s], [m³/s²], and the power into it [W].

    Parameters
    ----------
    end, within
        Pressures at the valves' end and in the chamber [Pa].
    into, along
        Flows out of the valves and towards the chamber [m³/s].
    hose
        Its volume [m³].
    inertance, resistance
        Of its oil [Pa s²/m³], [Pa s/m³].
    machine
        Oil and hose.
    """
    modulus = 1 / (1 / machine.oil + 1 / machine.hose)  # Eq. 4 of a volume that is all hose
    more, drop = into - along, end - within
    rate = pressure_rate(end, modulus / hose * more)
    return rate, (drop - resistance * along) / inertance, end * more + drop * along
