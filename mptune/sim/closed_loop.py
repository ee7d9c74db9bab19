"""The closed loop tick by tick: machine, valves, sensors, filters, outer loops, force controller.

A tick is T_S,fast. Sensors are sampled and filtered at each; the outer loops and the force
controller run at every T_S / T_S,fast-th. Between ticks the machine is integrated by the classical
Runge-Kutta method with a fixed step; valve ramps are sampled at its stages.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, IntArray, inlined_kernel, kernel
from mptune.force.cost import force_limits, supply_pressures
from mptune.force.select import decide
from mptune.force.stop import stopped
from mptune.plant.machine import (
    CONVERTER,
    ENERGIES,
    LINE_STATES,
    OIL,
    PRESSURE_A,
    PRESSURE_B,
    STATES,
    VALVE_END_A,
    VALVE_END_B,
    V,
    X,
    rates,
    rates_with_lines,
)
from mptune.plant.piston import burden_at
from mptune.plant.supplies import accumulator_pressure
from mptune.plant.valve import ValveState, advance, command, open_valves, quiet
from mptune.signals.conditioning import backlash, median_of_three
from mptune.signals.trajectory import reference
from mptune.signals.tustin import discretise

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.force.search_space import SearchSpace
    from mptune.params.pack import (
        FeedforwardTuple,
        ForceSettings,
        LoopGains,
        Machine,
        SignalSettings,
    )
    from mptune.plant.piston import Burden

SUBSTEPS, CALM_SUBSTEPS = 5, 2  # of the machine's integration in one tick of 0.5 ms
_CALM = 1e4  # Pa over one tick: slower pressures are calm

# Signals that are measured: position, both chamber pressures, both supplies, four converters.
SIGNALS = 9
# Columns of a trace.
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
    CONVERTER_1,
    _,
    _,
    _,
    HIGH_PRESSURE,
) = range(15)
COLUMNS = 15
# Places in ``Memory.outer``.
LAG1, LAG2, INTEGRAL, LAST_ERROR, REFERENCE, VELOCITY_REFERENCE, FORCE, STOPPED, PUMPING = range(9)


class Delays(NamedTuple):
    """Valve timing [s]: pure delays are drawn between the two for each switching."""

    least: float
    largest: float
    ramp: float


class Memory(NamedTuple):
    """What machine and controller carry from tick to tick."""

    state: FloatArray  # (13,) of the machine; (9,) are used but with hoses as lines
    energy: FloatArray  # (8,) J
    valves: ValveState
    raw: FloatArray  # (2, 9) the last two samples of each signal
    filtered: FloatArray  # (9,)
    history: FloatArray  # (6,) filtered positions, newest first
    converters: FloatArray  # (4,) behind the backlash
    outer: FloatArray  # (9,)
    choice: IntArray  # (2,) valve states of A and B


class Work(NamedTuple):
    """Room for the integration: slopes, powers, and open valves at a step's start, middle, end."""

    k1: FloatArray  # (9,)
    k2: FloatArray
    k3: FloatArray
    k4: FloatArray
    ahead: FloatArray
    power: FloatArray  # (8,)
    start_a: FloatArray  # (6,)
    start_b: FloatArray
    middle_a: FloatArray
    middle_b: FloatArray
    end_a: FloatArray
    end_b: FloatArray


@kernel
def new_work(valves: ValveState) -> Work:
    """Return room for the integration, with the valves as they stand."""
    work = Work(
        np.zeros(LINE_STATES),
        np.zeros(LINE_STATES),
        np.zeros(LINE_STATES),
        np.full(LINE_STATES, np.inf),  # nothing is calm before the first step
        np.zeros(LINE_STATES),
        np.empty(ENERGIES),
        np.empty(6),
        np.empty(6),
        np.empty(6),
        np.empty(6),
        np.empty(6),
        np.empty(6),
    )
    open_valves(valves, work.start_a, work.start_b)
    open_valves(valves, work.middle_a, work.middle_b)
    open_valves(valves, work.end_a, work.end_b)
    return work


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
    """Run the closed loop over one movement set and fill ``trace`` ``(T, 15)``.

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
    law = discretise(gains, settings.sampling_period)
    work = new_work(memory.valves)
    for tick in range(len(trace)):
        now = begin + tick * tick_time
        step, v_ref, a_ref = reference(tick * tick_time, pieces)
        x_ref = start + step
        outer = memory.outer
        outer[REFERENCE] += (1 - ahead.reference_pole) * (x_ref - outer[REFERENCE])
        outer[VELOCITY_REFERENCE] += (1 - ahead.velocity_reference_pole) * (
            v_ref - outer[VELOCITY_REFERENCE]
        )
        _measure(memory, machine, signals, random)
        if tick % signals.ticks == 0:
            _control(memory, x_ref, v_ref, a_ref, gains, law, ahead, signals, settings, space)
            _switch(memory, space, now, delays, random)
        _record(trace[tick], memory, x_ref, v_ref, machine)
        high = accumulator_pressure(memory.state[OIL], machine)
        if high < machine.pump_on:
            outer[PUMPING] = 1.0
        elif high > machine.pump_off:
            outer[PUMPING] = 0.0
        _integrate(memory, machine, table, delays.ramp, now, tick_time, work)


@kernel
def _measure(
    memory: Memory, machine: Machine, signals: SignalSettings, random: np.random.Generator
) -> None:
    """Sample every sensor, take the median of three, filter; then backlash and history."""
    state = memory.state
    for i in range(SIGNALS):
        if i == 0:
            value, noise, pole = state[X], signals.position_noise, signals.position_pole
        elif i <= 2:
            value, noise, pole = state[i + 1], signals.pressure_noise, signals.pressure_pole
        elif i == 3:
            value = accumulator_pressure(state[OIL], machine)
            noise, pole = signals.pressure_noise, signals.supply_pole
        elif i == 4:
            value, noise = machine.low_pressure, signals.pressure_noise
            pole = signals.supply_pole
        else:
            value, noise = state[CONVERTER + i - 5], signals.converter_noise
            pole = signals.supply_pole
        sample = value + noise * random.standard_normal()
        middle = median_of_three(sample, memory.raw[0, i], memory.raw[1, i])
        memory.raw[1, i] = memory.raw[0, i]
        memory.raw[0, i] = sample
        memory.filtered[i] = pole * memory.filtered[i] + (1 - pole) * middle
    for i in range(4):
        memory.converters[i] = backlash(
            memory.converters[i], memory.filtered[5 + i], signals.backlash
        )
    for tap in range(5, 0, -1):
        memory.history[tap] = memory.history[tap - 1]
    memory.history[0] = memory.filtered[0]


@kernel
def _control(
    memory: Memory,
    x_ref: float,
    v_ref: float,
    a_ref: float,
    gains: LoopGains,
    law: tuple[float, float, float, float, float, float],
    ahead: FeedforwardTuple,
    signals: SignalSettings,
    settings: ForceSettings,
    space: SearchSpace,
) -> None:
    """Run the outer loops and the force controller once; leave the valve states to command."""
    b0, b1, b2, a1, a2, rate = law
    outer, history = memory.outer, memory.history
    velocity = 0.0
    for tap in range(6):
        velocity += (5.0, 3.0, 1.0, -1.0, -3.0, -5.0)[tap] * history[tap]
    velocity /= 35 * signals.sample_time  # Eq. 23
    error = outer[REFERENCE] - history[0]
    shaped = b0 * error + outer[LAG1]
    outer[LAG1] = b1 * error - a1 * shaped + outer[LAG2]
    outer[LAG2] = b2 * error - a2 * shaped
    gained = rate * (error + outer[LAST_ERROR])
    if abs(error) < signals.dead_zone:
        gained = 0.0
    outer[LAST_ERROR] = error
    wanted = outer[VELOCITY_REFERENCE] + shaped + outer[INTEGRAL] - velocity
    force = gains.k_p_vel * (wanted + gained) + ahead.acceleration_mass * a_ref
    low, high = force_limits(settings)
    if not ((force > high and gained > 0) or (force < low and gained < 0)):  # anti-windup
        outer[INTEGRAL] += gained
    outer[FORCE] = min(max(force, low), high)
    stop = stopped(outer[STOPPED] > 0, x_ref - history[0], v_ref, signals)
    outer[STOPPED] = 1.0 if stop else 0.0
    if stop:
        memory.choice[0], memory.choice[1] = 0, 0
        return
    supplies = supply_pressures(memory.filtered[4], memory.filtered[3])
    memory.choice[0], memory.choice[1] = decide(
        outer[FORCE],
        memory.filtered[1],
        memory.filtered[2],
        history[0],
        velocity,
        supplies,
        memory.converters,
        memory.choice[0],
        memory.choice[1],
        space,
        settings,
    )


@kernel
def _switch(
    memory: Memory,
    space: SearchSpace,
    now: float,
    delays: Delays,
    random: np.random.Generator,
) -> None:
    """Command the valves of the chosen states, each with a delay of its own."""
    for side in range(2):
        for valve in range(12):
            wanted = float(space.valves[memory.choice[side], valve])
            if wanted != memory.valves.commanded[12 * side + valve]:
                delay = delays.least + (delays.largest - delays.least) * random.random()
                command(memory.valves, 12 * side + valve, wanted, now + delay)


@kernel
def _record(row: FloatArray, memory: Memory, x_ref: float, v_ref: float, machine: Machine) -> None:
    state = memory.state
    row[X_REF], row[V_REF] = x_ref, v_ref
    row[POSITION], row[VELOCITY] = state[X], state[V]
    row[CHAMBER_A], row[CHAMBER_B] = state[PRESSURE_A], state[PRESSURE_B]
    row[F_REF], row[ACTIVE] = memory.outer[FORCE], 1.0 - memory.outer[STOPPED]
    row[STATE_A], row[STATE_B] = memory.choice[0], memory.choice[1]
    for i in range(4):
        row[CONVERTER_1 + i] = state[CONVERTER + i]
    row[HIGH_PRESSURE] = accumulator_pressure(state[OIL], machine)


@kernel
def _integrate(
    memory: Memory,
    machine: Machine,
    table: FloatArray,
    ramp: float,
    now: float,
    span: float,
    work: Work,
) -> None:
    """Advance the machine over one tick.

    While no valve moves and the pressures hardly do, two steps are as good as five.
    """
    valves = memory.valves
    burden = burden_at(memory.state[X], machine, table)
    still = quiet(valves, now + span)
    rate = max(abs(work.k4[PRESSURE_A]), abs(work.k4[PRESSURE_B]))  # at the end of the last step
    substeps = CALM_SUBSTEPS if still and rate * span < _CALM else SUBSTEPS
    h = span / substeps
    for sub in range(substeps):
        at = now + sub * h
        moved = False
        if not still:
            moved = advance(valves, at, 0.5 * h, ramp)
            if moved:
                open_valves(valves, work.middle_a, work.middle_b)
            moved = advance(valves, at + 0.5 * h, 0.5 * h, ramp) or moved
            if moved:
                open_valves(valves, work.end_a, work.end_b)
        if machine.line_inertance > 0:
            runge_kutta_with_lines(memory, machine, burden, h, work)
        else:
            runge_kutta(memory, machine, burden, h, work)
        if moved:
            open_valves(valves, work.start_a, work.start_b)
            open_valves(valves, work.middle_a, work.middle_b)


@inlined_kernel
def _spend(energy: FloatArray, share: float, power: FloatArray) -> None:
    for i in range(ENERGIES):
        energy[i] += share * power[i]


def _stepper(slopes: Callable[..., None], count: int) -> Callable[..., None]:
    """Return one step of the classical Runge-Kutta method for a right-hand side of its own."""

    def step(memory: Memory, machine: Machine, burden: Burden, h: float, work: Work) -> None:
        state, energy, pumping = memory.state, memory.energy, memory.outer[PUMPING]
        k1, k2, k3, k4 = work.k1, work.k2, work.k3, work.k4
        ahead, power = work.ahead, work.power
        slopes(state, work.start_a, work.start_b, pumping, machine, burden, k1, power)
        _spend(energy, h / 6, power)
        for i in range(count):
            ahead[i] = state[i] + 0.5 * h * k1[i]
        slopes(ahead, work.middle_a, work.middle_b, pumping, machine, burden, k2, power)
        _spend(energy, h / 3, power)
        for i in range(count):
            ahead[i] = state[i] + 0.5 * h * k2[i]
        slopes(ahead, work.middle_a, work.middle_b, pumping, machine, burden, k3, power)
        _spend(energy, h / 3, power)
        for i in range(count):
            ahead[i] = state[i] + h * k3[i]
        slopes(ahead, work.end_a, work.end_b, pumping, machine, burden, k4, power)
        _spend(energy, h / 6, power)
        for i in range(count):
            state[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i])
        _stops(state, machine)

    return step


@inlined_kernel
def _stops(state: FloatArray, machine: Machine) -> None:
    """Hold piston, converters and pressures inside what is physically possible."""
    if state[X] < 0 or state[X] > machine.stroke:
        state[X] = min(max(state[X], 0.0), machine.stroke)
        state[V] = 0.0
    state[PRESSURE_A] = max(state[PRESSURE_A], 0.0)
    state[PRESSURE_B] = max(state[PRESSURE_B], 0.0)
    if machine.line_inertance > 0:
        state[VALVE_END_A] = max(state[VALVE_END_A], 0.0)
        state[VALVE_END_B] = max(state[VALVE_END_B], 0.0)
    for i in range(4):
        place = state[CONVERTER + i]
        state[CONVERTER + i] = min(max(place, -machine.converter_travel), machine.converter_travel)


runge_kutta = inlined_kernel(_stepper(rates, STATES))
runge_kutta_with_lines = kernel(_stepper(rates_with_lines, LINE_STATES))
