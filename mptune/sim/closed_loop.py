"""The closed loop tick by tick: machine, valves, sensors, filters, outer loops, force controller.

A tick is T_S,fast. Sensors are sampled and filtered at each, and a state estimator, where there
is one in the filters' place, is carried on; the outer loops and the force controller run at every
T_S / T_S,fast-th. Between ticks the machine is integrated.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, IntArray, kernel, lending_kernel
from mptune.force.cost import force_limits, line_pressures
from mptune.force.select import decide
from mptune.force.stop import stopped
from mptune.plant.machine import CONVERTER, OIL, PRESSURE_A, PRESSURE_B, V, X
from mptune.plant.supplies import accumulator_pressure
from mptune.plant.valve import SIDES, ValveState, command
from mptune.signals.adaptive_mass import fed_mass, learn_mass
from mptune.signals.conditioning import backlash, median_of_three
from mptune.signals.differentiator import differentiated, remember
from mptune.signals.estimator import estimate
from mptune.signals.outer_loop import (
    acceleration_ahead,
    force_reference,
    lag_references,
    outer_law,
)
from mptune.signals.states import (
    FORCE,
    LAST_VELOCITY_REFERENCE,
    OUTER_STATES,
    POSITION_HEARD,
    VELOCITY_HEARD,
)
from mptune.signals.trajectory import reference
from mptune.sim.integrator import integrate, new_work

if TYPE_CHECKING:
    from mptune.force.search_space import SearchSpace
    from mptune.params.packed import (
        FeedforwardTuple,
        ForceSettings,
        LoopGains,
        Machine,
        SignalSettings,
    )
    from mptune.signals.outer_loop import OuterLaw

# Signals that are measured: position, both chamber pressures, highest and lowest line; then the
# converters.
SIGNALS = 5
# Columns of a trace; those of the converters follow.
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
# Places in ``Memory.outer`` behind the outer loops' own: whether the stop logic holds the valves
# shut, whether the pump runs, and where the position sensor's hysteresis stands. An array more in
# ``Memory`` costs a tenth of the speed.
STOPPED, PUMPING, SENSED = range(OUTER_STATES, OUTER_STATES + 3)
OUTER_PLACES = OUTER_STATES + 3


class Delays(NamedTuple):
    """Valve timing [s]: pure delays are drawn between the two for each switching."""

    least: float
    largest: float
    ramp: float


class Memory(NamedTuple):
    """What machine and controller carry from tick to tick."""

    state: FloatArray  # (S + 4,) of the machine; S are used but with hoses as lines
    energy: FloatArray  # (8,) J
    valves: ValveState
    raw: FloatArray  # (2, 5 + K) the last two samples of each signal
    filtered: FloatArray  # (5 + K,)
    history: FloatArray  # (6,) filtered positions, newest first
    converters: FloatArray  # (K,) behind the backlash
    outer: FloatArray  # (OUTER_PLACES,) of the outer loops, and those above
    choice: IntArray  # (2,) valve states of A and B


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
) -> None:
    """Run the closed loop over one movement set and fill ``trace`` ``(T, 12 + K)``.

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
    """
    tick_time = signals.sample_time
    outer, limits = memory.outer, force_limits(settings)
    law = outer_law(gains, ahead, settings.sampling_period, signals.dead_zone, limits)
    work = new_work(memory.valves, space.lines, space.edge, len(memory.state))
    for tick in range(len(trace)):
        now = begin + tick * tick_time
        step, v_ref, _ = reference(tick * tick_time, pieces)
        x_ref = start + step
        lag_references(outer, law, x_ref, v_ref)
        _measure(memory, machine, signals, settings, law, v_ref, random)
        if tick % signals.ticks == 0:
            fed = acceleration_ahead(tick * tick_time, pieces, ahead)
            _control(memory, x_ref, v_ref, fed, law, signals, settings, space)
            _switch(memory, space, now, delays, random)
        _record(trace[tick], memory, x_ref, v_ref, machine)
        trace[tick, FED_MASS] = fed_mass(outer, ahead)
        high = accumulator_pressure(memory.state[OIL], machine)
        if high < machine.pump_on:
            outer[PUMPING] = 1.0
        elif high > machine.pump_off:
            outer[PUMPING] = 0.0
        integrate(
            memory.state, memory.energy, memory.valves, outer[PUMPING],
            machine, table, delays.ramp, now, tick_time, work,
        )  # fmt: skip


@lending_kernel
def _sensed_position(memory: Memory, signals: SignalSettings) -> float:
    """Return where the position sensor's hysteresis stands [m]."""
    hysteresis = signals.sensors.hysteresis
    place: float = memory.state[X]
    if hysteresis > 0:
        place = backlash(memory.outer[SENSED], place, hysteresis)
        memory.outer[SENSED] = place
    return place


@lending_kernel
def _measure(  # noqa: C901 - one signal after another, in one loop for speed
    memory: Memory,
    machine: Machine,
    signals: SignalSettings,
    settings: ForceSettings,
    law: OuterLaw,
    v_ref: float,
    random: np.random.Generator,
) -> None:
    """Sample every sensor, take the median of three, filter; then backlash and history."""
    state, sensors = memory.state, signals.sensors
    place, force = 0.0, 0.0  # of the medians
    for i in range(len(memory.filtered)):
        if i == 0:
            value, noise = _sensed_position(memory, signals), signals.position_noise
            pole = signals.position_pole
        elif i == 1:
            value = sensors.gain_a * state[PRESSURE_A] + sensors.offset_a
            noise, pole = signals.pressure_noise, signals.pressure_pole
        elif i == 2:
            value = sensors.gain_b * state[PRESSURE_B] + sensors.offset_b
            noise, pole = signals.pressure_noise, signals.pressure_pole
        elif i == 3:
            value = accumulator_pressure(state[OIL], machine)
            noise, pole = signals.pressure_noise, signals.supply_pole
        elif i == 4:
            value, noise = machine.low_pressure, signals.pressure_noise
            pole = signals.supply_pole
        else:
            value, noise = state[CONVERTER + i - SIGNALS], signals.converter_noise
            pole = signals.supply_pole
        sample = value + noise * random.standard_normal()
        if i == 0 and sensors.quantum > 0:
            sample = sensors.quantum * np.rint(sample / sensors.quantum)
        middle = median_of_three(sample, memory.raw[0, i], memory.raw[1, i])
        memory.raw[1, i] = memory.raw[0, i]
        memory.raw[0, i] = sample
        memory.filtered[i] = pole * memory.filtered[i] + (1 - pole) * middle
        if i == 0:
            place = middle
        elif i == 1:
            force = settings.area_a * middle
        elif i == 2:
            force -= settings.area_b * middle
    for i in range(len(memory.converters)):
        memory.converters[i] = backlash(
            memory.converters[i], memory.filtered[SIGNALS + i], signals.backlash
        )
    remember(memory.history, memory.filtered[0])
    know_load(memory.outer, law.ahead, signals, place, force, v_ref)


@lending_kernel
def know_load(
    outer: FloatArray,
    ahead: FeedforwardTuple,
    signals: SignalSettings,
    position: float,
    force: float,
    v_ref: float,
) -> None:
    """Carry on what hears the force: the state estimator, and the mass that is learnt."""
    by = signals.estimator
    if by.mass > 0:
        estimate(outer, by, signals.sample_time, position, force, v_ref, fed_mass(outer, ahead))
    if ahead.adaptive > 0:
        learn_mass(outer, ahead, force, v_ref)
    outer[LAST_VELOCITY_REFERENCE] = v_ref


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
        memory.choice[0], memory.choice[1] = 0, 0
        return
    supplies = line_pressures(memory.filtered[4], memory.filtered[3], space)
    memory.choice[0], memory.choice[1] = decide(
        force,
        memory.filtered[1],
        memory.filtered[2],
        position,
        velocity,
        supplies,
        memory.converters,
        memory.choice[0],
        memory.choice[1],
        space,
        settings,
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
    for side in range(SIDES):
        for valve in range(each):
            wanted = float(space.valves[memory.choice[side], valve])
            if wanted != memory.valves.commanded[each * side + valve]:
                delay = delays.least + (delays.largest - delays.least) * random.random()
                command(memory.valves, each * side + valve, wanted, now + delay)


@lending_kernel
def _record(row: FloatArray, memory: Memory, x_ref: float, v_ref: float, machine: Machine) -> None:
    state = memory.state
    row[X_REF], row[V_REF] = x_ref, v_ref
    row[POSITION], row[VELOCITY] = state[X], state[V]
    row[CHAMBER_A], row[CHAMBER_B] = state[PRESSURE_A], state[PRESSURE_B]
    row[F_REF], row[ACTIVE] = memory.outer[FORCE], 1.0 - memory.outer[STOPPED]
    row[STATE_A], row[STATE_B] = memory.choice[0], memory.choice[1]
    for i in range(len(memory.converters)):
        row[CONVERTER_1 + i] = state[CONVERTER + i]
    row[HIGH_PRESSURE] = accumulator_pressure(state[OIL], machine)
