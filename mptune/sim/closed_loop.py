"""The closed loop tick by tick: machine, valves, sensors, filters, outer loops, force controller.

A tick is T_S,fast. Sensors are sampled and filtered at each, and a state estimator, where there
is one in the filters' place, is carried on; the outer loops and the force controller run at every
T_S / T_S,fast-th. Between ticks the machine is integrated.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, kernel, lending_kernel
from mptune.force.chambers import decide_of_chambers
from mptune.force.cost import force_limits, line_pressures
from mptune.force.select import decide
from mptune.force.stop import stopped
from mptune.plant.chambers import place_of
from mptune.plant.machine import CONVERTER, OIL, PRESSURE_A, PRESSURE_B, V, X
from mptune.plant.supplies import accumulator_pressure
from mptune.plant.valve import command
from mptune.signals.adaptive_mass import fed_mass
from mptune.signals.differentiator import differentiated
from mptune.signals.outer_loop import (
    acceleration_ahead,
    force_reference,
    lag_references,
    outer_law,
)
from mptune.signals.states import FORCE, POSITION_HEARD, VELOCITY_HEARD
from mptune.signals.trajectory import reference
from mptune.sim.integrator import integrate, new_work
from mptune.sim.measure import measure
from mptune.sim.memory import FIRST_CHAMBERS, PUMPING, STOPPED, Memory, chamber_of_signal

if TYPE_CHECKING:
    from mptune.force.search_space import SearchSpace
    from mptune.params.packed import (
        FeedforwardTuple,
        ForceSettings,
        LoopGains,
        Machine,
        MoreChambers,
        SignalSettings,
    )
    from mptune.signals.outer_loop import OuterLaw

# Columns of a trace; those of the converters follow, then the pressures of further chambers, then
# their states.
(
    X_REF,
    V_REF,
    POSITION,
    VELOCITY,
    CHAMBER_A,
    CHAMBER_B,
    F_REF,
    ACTIVE,
    STATE_A,
    STATE_B,
    HIGH_PRESSURE,
    FED_MASS,
    CONVERTER_1,
) = range(13)


class ChamberColumns(NamedTuple):
    """Where in a trace each chamber's pressure and valve state stand, and how wide it is."""

    pressures: list[int]
    states: list[int]
    width: int


def chamber_columns(converters: int, chambers: int) -> ChamberColumns:
    """Return the columns of so many chambers in the traces of a machine with converters."""
    behind, further = CONVERTER_1 + converters, chambers - FIRST_CHAMBERS
    pressures = [CHAMBER_A, CHAMBER_B, *range(behind, behind + further)]
    states = [STATE_A, STATE_B, *range(behind + further, behind + 2 * further)]
    return ChamberColumns(pressures, states, behind + 2 * further)


class Delays(NamedTuple):
    """Valve timing [s]: pure delays are drawn between the two for each switching."""

    least: float
    largest: float
    ramp: float


@kernel
def run_ticks(
    memory: Memory,
    machine: Machine,
    table: FloatArray,
    delays: Delays,
    gains: LoopGains,
    ahead: FeedforwardTuple,
    signals: SignalSettings,
    settings: ForceSettings,
    space: SearchSpace,
    pieces: FloatArray,
    start: float,
    begin: float,
    random: np.random.Generator,
    trace: FloatArray,
    more: MoreChambers | None = None,
) -> None:
    """Run the closed loop over one movement set and fill ``trace`` ``(T, 12 + K)``.

    With C > 2 chambers 2 (C − 2) columns follow.

    Parameters
    ----------
    memory
        Where the loop stands; carried on in place.
    machine, table, delays, gains, ahead, signals, settings, space
        The machine and its controller.
    pieces
        ``(P, 7)`` the reference, see ``mptune.signals.trajectory``.
    start
        Position before the first move [m].
    begin
        Time at which the set begins [s].
    random
        Source of sensor noise and valve delays.
    more
        The machine's chambers where there are more than two.
    """
    tick_time = signals.sample_time
    outer, limits = memory.outer, force_limits(settings)
    law = outer_law(gains, ahead, settings.sampling_period, signals.dead_zone, limits)
    work = new_work(memory.valves, space.lines, space.edge, len(memory.state), more)
    for tick in range(len(trace)):
        now = begin + tick * tick_time
        step, v_ref, _ = reference(tick * tick_time, pieces)
        x_ref = start + step
        lag_references(outer, law, x_ref, v_ref)
        measure(memory, machine, signals, settings, law, v_ref, random, more)
        if tick % signals.ticks == 0:
            fed = acceleration_ahead(tick * tick_time, pieces, ahead)
            _control(memory, x_ref, v_ref, fed, law, signals, settings, space, more)
            _switch(memory, space, now, delays, random)
        _record(trace[tick], memory, x_ref, v_ref, machine, more)
        trace[tick, FED_MASS] = fed_mass(outer, ahead)
        high = accumulator_pressure(memory.state[OIL], machine)
        if high < machine.pump_on:
            outer[PUMPING] = 1.0
        elif high > machine.pump_off:
            outer[PUMPING] = 0.0
        integrate(
            memory.state, memory.energy, memory.valves, outer[PUMPING],
            machine, table, delays.ramp, now, tick_time, work, more,
        )  # fmt: skip


@kernel
def _control(
    memory: Memory,
    x_ref: float,
    v_ref: float,
    fed: float,
    law: OuterLaw,
    signals: SignalSettings,
    settings: ForceSettings,
    space: SearchSpace,
    more: MoreChambers | None = None,
) -> None:
    """Run the outer loops and the force controller once; leave the valve states to command."""
    position, velocity = memory.outer[POSITION_HEARD], memory.outer[VELOCITY_HEARD]
    if signals.estimator.mass == 0:
        position = memory.history[0]
        velocity = differentiated(memory.history, signals.sample_time)
    force = force_reference(memory.outer, law, position, velocity, fed)
    stop = stopped(memory.outer[STOPPED] > 0, x_ref - position, v_ref, signals)
    memory.outer[STOPPED] = 1.0 if stop else 0.0
    if stop:
        memory.choice[:] = 0
        return
    if more is not None:
        decide_for_more(memory, force, position, velocity, space, more)
        return
    memory.choice[0], memory.choice[1] = decide(
        force,
        memory.filtered[1],
        memory.filtered[2],
        position,
        velocity,
        line_pressures(memory.filtered[4], memory.filtered[3], space),
        memory.converters,
        memory.choice[0],
        memory.choice[1],
        space,
        settings,
    )


@kernel
def decide_for_more(
    memory: Memory,
    force: float,
    position: float,
    velocity: float,
    space: SearchSpace,
    more: MoreChambers,
) -> None:
    """Replace the choice of a machine of more than two chambers.

    It is a kernel of its own so that the cache tells for which machines the loop is compiled, see
    ``mptune.job.precompile``; for two chambers another call would cost a hundredth of the speed.
    """
    pressures = np.empty(len(memory.choice))
    for i in range(len(memory.filtered)):
        chamber = chamber_of_signal(i, len(memory.converters))
        if chamber >= 0:
            pressures[chamber] = memory.filtered[i]
    decide_of_chambers(
        force,
        pressures,
        position,
        velocity,
        line_pressures(memory.filtered[4], memory.filtered[3], space),
        memory.converters,
        memory.choice,
        space,
        more,
    )


@lending_kernel
def _switch(
    memory: Memory,
    space: SearchSpace,
    now: float,
    delays: Delays,
    random: np.random.Generator,
) -> None:
    """Command the valves of the chosen states, each with a delay of its own."""
    each = space.valves.shape[1]
    for side in range(len(memory.choice)):
        for valve in range(each):
            wanted = float(space.valves[memory.choice[side], valve])
            if wanted != memory.valves.commanded[each * side + valve]:
                delay = delays.least + (delays.largest - delays.least) * random.random()
                command(memory.valves, each * side + valve, wanted, now + delay)


@lending_kernel
def _record(
    row: FloatArray,
    memory: Memory,
    x_ref: float,
    v_ref: float,
    machine: Machine,
    more: MoreChambers | None = None,
) -> None:
    state = memory.state
    row[X_REF], row[V_REF] = x_ref, v_ref
    row[POSITION], row[VELOCITY] = state[X], state[V]
    row[CHAMBER_A], row[CHAMBER_B] = state[PRESSURE_A], state[PRESSURE_B]
    row[F_REF], row[ACTIVE] = memory.outer[FORCE], 1.0 - memory.outer[STOPPED]
    row[STATE_A], row[STATE_B] = memory.choice[0], memory.choice[1]
    for i in range(len(memory.converters)):
        row[CONVERTER_1 + i] = state[CONVERTER + i]
    if more is not None:
        behind, further = CONVERTER_1 + len(memory.converters), len(memory.choice) - FIRST_CHAMBERS
        for i in range(further):
            row[behind + i] = state[place_of(FIRST_CHAMBERS + i, machine)]
            row[behind + further + i] = memory.choice[FIRST_CHAMBERS + i]
    row[HIGH_PRESSURE] = accumulator_pressure(state[OIL], machine)
