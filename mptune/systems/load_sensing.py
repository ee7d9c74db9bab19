"""Electric load sensing with a mobile proportional valve (§7.1).

::

    v = v_ref + K_x (x_ref − x_f)                                       every T_S
    u = ±(κd + (1 − d)|Q|/Q_N),  Q = A v of the chamber that is fed     κ: known of the dead band d
    Q_in = K_in o √min(p_S − p, Δp_c),  Q_out = K_out o √p              o: the spool's opening
    T ṗ_S = max(p + Δp_LS, p_standby) − p_S                            p of the chamber that is fed

The pump is ideal: what it delivers is p_S Q_in and nothing else, so that its losses, and what an
idling pump costs, are left out; the loss errs on the low side. The tank is at 0 Pa.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, kernel
from mptune.force.stop import stopped
from mptune.plant.flow import orifice
from mptune.plant.piston import Burden, burden_at
from mptune.signals.conditioning import backlash
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
from mptune.systems.sensing import Sensed, sense, settled_sensors
from mptune.systems.spool import (
    Spool,
    command_for,
    delayed,
    inlet_flow,
    opening_of,
    spool_rates,
)
from mptune.systems.trace import note

if TYPE_CHECKING:
    from mptune.params.packed import Machine, SignalSettings
    from mptune.params.systems import LoadSensing
    from mptune.sim.record import RunRecord

_SUPPLY, _PLACE, _RATE = PRESSURE + 2, PRESSURE + 3, PRESSURE + 4
_STATES = PRESSURE + 5
_PRESSURES = 3  # in the trace: both chambers and the pump
_START_PRESSURE_B = 2e6  # Pa; p_A follows from the balance of forces
_WANTED, _PLAYED, _STOPPED = range(3)  # the controller's memory


class Pump(NamedTuple):
    """The load-sensing pump, ideal but for its lag."""

    margin: float  # Pa above the load
    standby: float  # Pa, at least
    lag: float  # s


def run_load_sensing(
    bench: LoadBench, position_gain: float, system: LoadSensing
) -> tuple[RunRecord, ...]:
    """Run the moves and return one record per movement set.

    Parameters
    ----------
    bench
        Load, moves and sensors.
    position_gain
        K_x [1/s].
    system
        The valve and the pump.
    """
    machine, chambers = bench.machine, two_chambers(bench.machine)
    inlet = system.rated_flow / np.sqrt(system.compensated_pressure)
    valve = Spool(
        inlet=inlet,
        outlet=system.meter_out_ratio * inlet,
        compensated=system.compensated_pressure,
        frequency=system.spool_frequency,
        damping=system.spool_damping,
        dead_time=system.dead_time,
        rate=system.spool_rate,
        play=system.play,
        dead_band=system.dead_band,
        known_band=system.dead_band * system.dead_band_known,
        transition=machine.transition_pressure,
    )
    pump = Pump(system.margin, system.standby_pressure, system.pump_lag)
    state = np.zeros(_STATES)
    state[X], state[PRESSURE + 1] = bench.start, _START_PRESSURE_B
    state[PRESSURE] = (bench.load + machine.area_b * _START_PRESSURE_B) / machine.area_a
    state[_SUPPLY] = pump.standby
    sensors = settled_sensors(bench.start, np.zeros(0))
    memory = np.array([0.0, 0.0, 1.0])
    late = np.zeros(max(round(valve.dead_time / bench.signals.sample_time), 1))

    def run_set(trace: FloatArray, begin: float) -> None:
        _run_ticks(
            state, sensors, memory, late, machine, bench.table, chambers, valve, pump,
            position_gain, bench.signals, bench.moves.pieces, bench.start, begin, bench.substeps,
            bench.random, trace,
        )  # fmt: skip

    return movement_sets(bench, state, 2, _PRESSURES, run_set)


@kernel
def _run_ticks(
    state: FloatArray,
    sensors: Sensed,
    memory: FloatArray,
    late: FloatArray,
    machine: Machine,
    table: FloatArray,
    chambers: PistonChambers,
    valve: Spool,
    pump: Pump,
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
    offset = int(np.rint(begin / span))
    for tick in range(len(trace)):
        step, v_ref, _ = reference(tick * span, pieces)
        x_ref = start + step
        sense(sensors, state, PRESSURE, signals, random)
        if tick % signals.ticks == 0:
            error = x_ref - sensors.history[0]
            stop = stopped(memory[_STOPPED] > 0, error, v_ref, signals)
            memory[_STOPPED] = 1.0 if stop else 0.0
            speed = 0.0 if stop else v_ref + gain * error
            fed = machine.area_a if speed > 0 else machine.area_b
            memory[_WANTED] = command_for(speed * fed, valve)
        command = delayed(late, offset + tick, memory[_WANTED])
        memory[_PLAYED] = backlash(memory[_PLAYED], command, valve.play)
        note(trace[tick], state, chambers, x_ref, v_ref, np.nan, 1.0 - memory[_STOPPED])
        burden = burden_at(state[X], machine, table)
        for _ in range(substeps):
            _step(
                state, memory[_PLAYED], flow, chambers, machine, burden, valve, pump,
                span / substeps, work,
            )  # fmt: skip


@kernel
def _step(
    state: FloatArray,
    command: float,
    flow: FloatArray,
    chambers: PistonChambers,
    machine: Machine,
    burden: Burden,
    valve: Spool,
    pump: Pump,
    h: float,
    work: StepRoom,
) -> None:
    """Advance the system by the classical Runge-Kutta method."""
    ahead = work.ahead
    _rates(state, command, flow, chambers, machine, burden, valve, pump, work.k1)
    look_ahead(state, work.k1, 0.5 * h, ahead)
    _rates(ahead, command, flow, chambers, machine, burden, valve, pump, work.k2)
    look_ahead(state, work.k2, 0.5 * h, ahead)
    _rates(ahead, command, flow, chambers, machine, burden, valve, pump, work.k3)
    look_ahead(state, work.k3, h, ahead)
    _rates(ahead, command, flow, chambers, machine, burden, valve, pump, work.k4)
    settle(state, work, h, 2, machine.stroke)


@kernel
def _rates(
    state: FloatArray,
    command: float,
    flow: FloatArray,
    chambers: PistonChambers,
    machine: Machine,
    burden: Burden,
    valve: Spool,
    pump: Pump,
    slope: FloatArray,
) -> None:
    """Fill the slopes of all states: spool, pump, chambers and piston."""
    opening, supply = opening_of(state[_PLACE], valve), state[_SUPPLY]
    slope[_PLACE], slope[_RATE] = spool_rates(command, state[_PLACE], state[_RATE], valve)
    flow[0] = flow[1] = 0.0
    slope[DRAWN] = slope[THROTTLING] = 0.0
    wanted = pump.standby
    if opening != 0:
        fed, drained = (0, 1) if opening > 0 else (1, 0)
        load, back = state[PRESSURE + fed], state[PRESSURE + drained]
        size = abs(opening)
        into = inlet_flow(size, supply, load, valve)
        out = valve.outlet * size * orifice(back, valve.transition)
        flow[fed], flow[drained] = into, -out
        slope[DRAWN] = supply * into
        slope[THROTTLING] = (supply - load) * into + back * out
        wanted = max(load + pump.margin, wanted)
    slope[_SUPPLY] = (wanted - supply) / pump.lag
    piston_rates(state, flow, chambers, machine, burden, slope)
