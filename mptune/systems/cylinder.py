"""A piston between any number of chambers: Eq. 1 and Eq. 4, whatever it is that feeds them.

State, SI: position and velocity; energies since the start; chamber pressures; then what the system
adds. Energies are states like any other, so that they close as well as the integration is exact.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, inlined_kernel, kernel
from mptune.plant.machine import chamber_rate
from mptune.plant.piston import Burden, friction

if TYPE_CHECKING:
    from mptune.params.packed import Machine

X, V = 0, 1
# Energies [J]: from the high-pressure supply, from the low-pressure side (negative where more flows
# back), to the load at the piston, into valves and into the oil; then how much of the piston's went
# into friction, and into load and inertia.
DRAWN, RETURNED, DELIVERED, THROTTLING, COMPRESSION, RUBBED, MOVED = range(2, 9)
ENERGIES = slice(DRAWN, MOVED + 1)
PRESSURE = 9  # of the first chamber; the others follow


class PistonChambers(NamedTuple):
    """The chambers of a cylinder, ``(C,)`` each."""

    area: FloatArray  # m², positive where pressure extends the piston
    dead: FloatArray  # m³ with the piston at the chamber's end, hose included
    hose: FloatArray  # m³, of it


class StepRoom(NamedTuple):
    """Room for one step: slopes and the state ahead, ``(S,)`` each."""

    k1: FloatArray
    k2: FloatArray
    k3: FloatArray
    k4: FloatArray
    ahead: FloatArray


def two_chambers(machine: Machine) -> PistonChambers:
    """Return the chambers of this study's own cylinder, A and B."""
    return PistonChambers(
        np.array([machine.area_a, -machine.area_b]),
        np.array([machine.dead_a, machine.dead_b]),
        np.array([machine.hose_a, machine.hose_b]),
    )


@kernel
def step_room(states: int) -> StepRoom:
    """Return room for the steps of a system of ``states`` states."""
    return StepRoom(
        np.zeros(states), np.zeros(states), np.zeros(states), np.zeros(states), np.zeros(states)
    )


@kernel
def piston_force(state: FloatArray, chambers: PistonChambers) -> float:
    """Return the force of all chambers on the piston [N]."""
    force: float = 0.0
    for i in range(len(chambers.area)):
        force += chambers.area[i] * state[PRESSURE + i]
    return float(force)


@kernel
def volume_of(position: float, i: int, chambers: PistonChambers, stroke: float) -> float:
    """Return the volume of chamber ``i`` with its hose [m³]."""
    area = chambers.area[i]
    swept = area * position if area > 0 else -area * (stroke - position)
    return float(chambers.dead[i] + swept)


@inlined_kernel
def piston_rates(
    state: FloatArray,
    flow: FloatArray,
    chambers: PistonChambers,
    machine: Machine,
    burden: Burden,
    slope: FloatArray,
) -> None:
    """Fill the slopes of piston and chambers, and the powers that belong to them.

    Parameters
    ----------
    state
        ``(S,)``.
    flow
        ``(C,)`` into each chamber [m³/s].
    chambers, machine, burden
        The cylinder; of the machine only stroke, oil, hose and friction are used; the load.
    slope
        ``(S,)``, filled as far as said.
    """
    velocity, squeezed = state[V], 0.0
    for i in range(len(flow)):
        pressure = state[PRESSURE + i]
        volume = volume_of(state[X], i, chambers, machine.stroke)
        net = flow[i] - chambers.area[i] * velocity
        slope[PRESSURE + i] = chamber_rate(pressure, volume, chambers.hose[i], net, machine)
        squeezed += pressure * net
    force = piston_force(state, chambers)
    away = state[X] - burden.position
    rubbing = friction(velocity, machine)
    opposed = burden.force + burden.stiffness * away + 0.5 * burden.mass_slope * velocity * velocity
    slope[X] = velocity
    # Eq. 1, line 3
    slope[V] = (force - opposed - rubbing) / (burden.mass + burden.mass_slope * away)
    slope[DELIVERED] = force * velocity
    slope[COMPRESSION] = squeezed
    slope[RUBBED] = rubbing * velocity
    slope[MOVED] = (force - rubbing) * velocity


@kernel
def look_ahead(state: FloatArray, slope: FloatArray, step: float, ahead: FloatArray) -> None:
    """Fill ``ahead`` with the state a step on, at a constant slope."""
    for i in range(len(state)):
        ahead[i] = state[i] + step * slope[i]


@kernel
def settle(state: FloatArray, work: StepRoom, step: float, chambers: int, stroke: float) -> None:
    """End a step of the classical Runge-Kutta method inside what is physically possible."""
    k1, k2, k3, k4 = work.k1, work.k2, work.k3, work.k4
    for i in range(len(state)):
        state[i] += step / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i])
    if state[X] < 0 or state[X] > stroke:
        state[X] = min(max(state[X], 0.0), stroke)
        state[V] = 0.0
    for i in range(PRESSURE, PRESSURE + chambers):
        state[i] = max(state[i], 0.0)
