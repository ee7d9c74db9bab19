"""Machine and controller at rest, where a run begins."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.force.cost import force_limits
from mptune.params.chambers import Side
from mptune.params.pack import pack_force, pack_table
from mptune.params.packed import NO_FEEDFORWARD
from mptune.plant import machine as plant
from mptune.plant.piston import burden_at
from mptune.plant.supplies import oil_at_pressure
from mptune.plant.valve import shut_valves
from mptune.signals.adaptive_mass import start_learning
from mptune.signals.states import INTEGRAL, LOAD_HEARD, POSITION_HEARD, REFERENCE
from mptune.sim.memory import OUTER_PLACES, SENSED, Memory

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.params.packed import FeedforwardTuple, LoopGains, Machine
    from mptune.params.study import ResolvedStudy
    from mptune.params.supplies import Supplies

_START_PRESSURE_B = 6e6  # Pa; p_A follows from the balance of forces


def new_memory(
    study: ResolvedStudy,
    machine: Machine,
    gains: LoopGains,
    start: float,
    ahead: FeedforwardTuple = NO_FEEDFORWARD,
) -> Memory:
    """Return machine and controller at rest at ``start`` [m].

    The chamber pressures, alike on either side, carry the load, and so does the integrator, as far
    as the controller can: there is none without K_I,pos, and F_ref has its limits.
    """
    supplies = study.study.supplies
    high = 0.5 * (supplies.pump_on + supplies.pump_off)
    load = burden_at(start, machine, pack_table(study)).force
    pressure_b = _start_pressure_b(load, machine, supplies)
    pressure_a = (load + machine.area_b * pressure_b) / machine.area_a
    own = plant.CONVERTER + machine.converters
    sides = [one.side for one in study.study.all_chambers]
    every = [pressure_a if side is Side.PUSHING else pressure_b for side in sides]
    further = every[2:]
    # Chambers, then the valves' ends of the hoses as lines, then the flows along these.
    behind = [*further, *every, *np.zeros(len(every))]
    state: FloatArray = np.zeros(own + len(behind))
    state[plant.X], state[plant.OIL] = start, oil_at_pressure(high, machine)
    state[[plant.PRESSURE_A, plant.PRESSURE_B]] = every[:2]
    state[own:] = behind
    usual = (start, pressure_a, pressure_b, high, machine.low_pressure)
    signals = np.array([*usual, *np.zeros(machine.converters), *further])
    outer = np.zeros(OUTER_PLACES)
    if gains.k_i_pos > 0:
        least, largest = force_limits(pack_force(study))
        outer[INTEGRAL] = min(max(load, least), largest) / gains.k_p_vel
    outer[[REFERENCE, POSITION_HEARD, SENSED]] = start
    outer[LOAD_HEARD] = machine.area_a * pressure_a - machine.area_b * pressure_b
    start_learning(outer, ahead, load)
    return Memory(
        state=state,
        energy=np.zeros(plant.ENERGIES),
        valves=shut_valves(len(sides) * study.study.edge_rule.valves),
        raw=np.stack([signals, signals]),
        filtered=signals.copy(),
        history=np.full(6, start),
        converters=np.zeros(machine.converters),
        outer=outer,
        choice=np.zeros(len(sides), np.int64),
    )


def _start_pressure_b(load: float, machine: Machine, supplies: Supplies) -> float:
    """Return p_B at the start [Pa], as usual where the lines hold both pressures then."""
    bounds = (supplies.low_pressure, supplies.high_pressure)
    ends = [(machine.area_a * bound - load) / machine.area_b for bound in bounds]
    least, largest = max(ends[0], bounds[0]), min(ends[1], bounds[1])
    return min(max(_START_PRESSURE_B, least), largest)
