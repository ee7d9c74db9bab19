"""Electric load sensing with four digital flow control units under steady-state speed control.

Edges: pump to A, A to tank, pump to B, B to tank; each is five on/off valves, 1:2:4:8:16. The
speed wanted is v_ref + K_x (x_ref − x_f); the force that the steady state is solved for is that of
the chamber pressures, filtered. The pump is ideal, as that of ``load_sensing``, and check valves
keep its flow from running back.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import FloatArray, IntArray, kernel
from mptune.force.stop import stopped
from mptune.plant.flow import orifice
from mptune.plant.piston import Burden, burden_at
from mptune.plant.valve import ValveState, shut_valves
from mptune.signals.trajectory import reference
from mptune.systems.bench import LoadBench, movement_sets
from mptune.systems.cylinder import (
    DRAWN,
    PRESSURE,
    THROTTLING,
    PistonChambers,
    StepRoom,
    X,
    look_ahead,
    piston_rates,
    settle,
    step_room,
    two_chambers,
)
from mptune.systems.load_sensing import Pump
from mptune.systems.sensing import Sensed, sense, settled_sensors
from mptune.systems.steady_speed import SpeedWeights, cheapest_pair, level_weights
from mptune.systems.switching import Timing, ones, openings, switch, timing_of
from mptune.systems.trace import note

if TYPE_CHECKING:
    from mptune.params.packed import Machine, SignalSettings
    from mptune.params.systems import DigitalValves
    from mptune.sim.record import RunRecord

_SUPPLY = PRESSURE + 2
_STATES = PRESSURE + 3
_PRESSURES = 3  # in the trace: both chambers and the pump
_PUMP_A, _A_TANK, _PUMP_B, _B_TANK = range(4)
_FORCE, _STOPPED = range(2)  # the controller's memory


def run_digital_valves(
    bench: LoadBench, position_gain: float, system: DigitalValves
) -> tuple[RunRecord, ...]:
    """Run the moves and return one record per movement set.

    Parameters
    ----------
    bench
        Load, moves and sensors.
    position_gain
        K_x [1/s].
    system
        The valves and the pump.
    """
    machine, chambers = bench.machine, two_chambers(bench.machine)
    pump = Pump(system.margin, system.standby_pressure, system.pump_lag)
    weights = SpeedWeights(system.back_pressure, system.weight_pressure, system.weight_switching)
    state = np.zeros(_STATES)
    state[X], state[PRESSURE + 1] = bench.start, system.back_pressure
    state[PRESSURE] = (bench.load + machine.area_b * system.back_pressure) / machine.area_a
    state[_SUPPLY] = pump.standby
    sensors = settled_sensors(bench.start, state[PRESSURE:].copy())
    memory, levels = np.array([bench.load, 1.0]), np.zeros(4, np.int64)
    valves, opened = shut_valves(), np.zeros((3, 4))
    timing = timing_of(system.delay, system.ramp)
    fade = float(np.exp(-bench.sampling_period / system.force_filter))

    def run_set(trace: FloatArray, begin: float) -> None:
        _run_ticks(
            state, sensors, memory, levels, valves, opened, machine, bench.table, chambers, pump,
            timing, level_weights(), system.flow_coefficient, fade, weights, position_gain,
            bench.signals, bench.moves.pieces, bench.start, begin, bench.substeps, bench.random,
            trace,
        )  # fmt: skip

    return movement_sets(bench, state, 2, _PRESSURES, run_set, lambda: int(valves.counters[0]))


@kernel
def _run_ticks(
    state: FloatArray,
    sensors: Sensed,
    memory: FloatArray,
    levels: IntArray,
    valves: ValveState,
    opened: FloatArray,
    machine: Machine,
    table: FloatArray,
    chambers: PistonChambers,
    pump: Pump,
    timing: Timing,
    sizes: FloatArray,
    edge: float,
    fade: float,
    weights: SpeedWeights,
    gain: float,
    signals: SignalSettings,
    pieces: FloatArray,
    start: float,
    begin: float,
    substeps: int,
    random: np.random.Generator,
    trace: FloatArray,
) -> None:
    """Run one movement set and fill its trace; a tick is T_S,fast."""
    work, flow = step_room(len(state)), np.zeros(2)
    span = signals.sample_time
    h = span / substeps
    for tick in range(len(trace)):
        now = begin + tick * span
        step, v_ref, _ = reference(tick * span, pieces)
        x_ref = start + step
        sense(sensors, state, PRESSURE, signals, random)
        if tick % signals.ticks == 0:
            error = x_ref - sensors.history[0]
            stop = stopped(memory[_STOPPED] > 0, error, v_ref, signals)
            memory[_STOPPED] = 1.0 if stop else 0.0
            _decide(
                sensors, memory, levels, 0.0 if stop else v_ref + gain * error, machine, edge,
                fade, weights,
            )  # fmt: skip
            for group in range(4):
                for k in range(5):
                    wanted = float((levels[group] >> k) & 1)
                    switch(valves, 5 * group + k, wanted, now, timing, random)
        note(trace[tick], state, chambers, x_ref, v_ref, np.nan, 1.0 - memory[_STOPPED])
        burden = burden_at(state[X], machine, table)
        for sub in range(substeps):
            openings(valves, sizes, now + sub * h, h, timing.ramp, opened)
            _step(state, opened, edge, flow, chambers, machine, burden, pump, h, work)


@kernel
def _decide(
    sensors: Sensed,
    memory: FloatArray,
    levels: IntArray,
    speed: float,
    machine: Machine,
    edge: float,
    fade: float,
    weights: SpeedWeights,
) -> None:
    """Choose the levels of all four edges, 0 to 31."""
    pressure_a, pressure_b, supply = sensors.filtered[1], sensors.filtered[2], sensors.filtered[3]
    force = machine.area_a * pressure_a - machine.area_b * pressure_b
    memory[_FORCE] = fade * memory[_FORCE] + (1 - fade) * force
    if speed == 0:
        levels[:] = 0
        return
    if speed > 0:
        inlet, outlet, area_in, area_out = _PUMP_A, _B_TANK, machine.area_a, machine.area_b
    else:
        inlet, outlet, area_in, area_out = _PUMP_B, _A_TANK, machine.area_b, machine.area_a
    others = 0
    for group in range(4):
        if group not in (inlet, outlet):
            others += ones(levels[group])
            levels[group] = 0
    levels[inlet], levels[outlet] = cheapest_pair(
        abs(speed), supply, memory[_FORCE] if speed > 0 else -memory[_FORCE], area_in, area_out,
        edge, levels[inlet], levels[outlet], others, weights,
    )  # fmt: skip


@kernel
def _step(
    state: FloatArray,
    opened: FloatArray,
    edge: float,
    flow: FloatArray,
    chambers: PistonChambers,
    machine: Machine,
    burden: Burden,
    pump: Pump,
    h: float,
    work: StepRoom,
) -> None:
    """Advance the system by the classical Runge-Kutta method."""
    ahead = work.ahead
    _rates(state, opened[0], edge, flow, chambers, machine, burden, pump, work.k1)
    look_ahead(state, work.k1, 0.5 * h, ahead)
    _rates(ahead, opened[1], edge, flow, chambers, machine, burden, pump, work.k2)
    look_ahead(state, work.k2, 0.5 * h, ahead)
    _rates(ahead, opened[1], edge, flow, chambers, machine, burden, pump, work.k3)
    look_ahead(state, work.k3, h, ahead)
    _rates(ahead, opened[2], edge, flow, chambers, machine, burden, pump, work.k4)
    settle(state, work, h, 2, machine.stroke)


@kernel
def _rates(
    state: FloatArray,
    opened: FloatArray,
    edge: float,
    flow: FloatArray,
    chambers: PistonChambers,
    machine: Machine,
    burden: Burden,
    pump: Pump,
    slope: FloatArray,
) -> None:
    """Fill the slopes of all states: pump, chambers and piston."""
    supply, transition = state[_SUPPLY], machine.transition_pressure
    wanted = pump.standby
    slope[DRAWN] = slope[THROTTLING] = 0.0
    for side in range(2):
        pressure = state[PRESSURE + side]
        inlet, outlet = opened[2 * side], opened[2 * side + 1]
        into = edge * inlet * max(orifice(supply - pressure, transition), 0.0)
        out = edge * outlet * orifice(pressure, transition)
        flow[side] = into - out
        slope[DRAWN] += supply * into
        slope[THROTTLING] += (supply - pressure) * into + pressure * out
        if inlet > 0:
            wanted = max(wanted, pressure + pump.margin)
    slope[_SUPPLY] = (wanted - supply) / pump.lag
    piston_rates(state, flow, chambers, machine, burden, slope)
