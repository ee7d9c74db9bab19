"""A cylinder of four chambers between two lines of constant pressure (§7.1, ref. 8).

A model of its own, kept small: chambers × lines × one valve each. The outer loops are those of this
machine, Eq. 18 and Eq. 22, and so are the stop logic and the feed-forward, with its preview, its
jerk and its friction. Two things of this machine are not taken: a mass that is learnt on line, of
which its start is fed, and the state estimator, for which the filters stand. What flows back into
the low line is lost, as in §7.1; the lines keep their pressure, so that what makes them is ideal
and the loss errs low.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import FloatArray, IntArray, kernel
from mptune.force.stop import stopped
from mptune.plant.flow import orifice
from mptune.plant.piston import Burden, burden_at
from mptune.plant.valve import ValveState, shut_valves
from mptune.signals.differentiator import differentiated
from mptune.signals.outer_loop import (
    acceleration_ahead,
    force_reference,
    lag_references,
    outer_law,
)
from mptune.signals.states import FORCE, INTEGRAL, OUTER_STATES, REFERENCE
from mptune.signals.trajectory import reference
from mptune.systems.bench import LoadBench, movement_sets
from mptune.systems.cylinder import (
    DRAWN,
    PRESSURE,
    RETURNED,
    THROTTLING,
    PistonChambers,
    StepRoom,
    X,
    look_ahead,
    piston_rates,
    settle,
    step_room,
)
from mptune.systems.secondary_force import (
    CHAMBERS,
    ForceWeights,
    Lines,
    cheapest_state,
    force_range,
    four_chambers,
)
from mptune.systems.sensing import Sensed, sense, settled_sensors
from mptune.systems.switching import Timing, openings, switch, timing_of
from mptune.systems.trace import note

if TYPE_CHECKING:
    from mptune.params.packed import FeedforwardTuple, LoopGains, Machine, SignalSettings
    from mptune.params.systems import FourChamber
    from mptune.sim.record import RunRecord

_STATES = PRESSURE + CHAMBERS
_STATE, _STOPPED = range(2)  # the controller's memory
_ALONE = np.ones((2 * CHAMBERS, 1))  # every valve is a group of its own


def run_four_chamber(
    bench: LoadBench, system: FourChamber, gains: LoopGains, ahead: FeedforwardTuple
) -> tuple[RunRecord, ...]:
    """Run the moves and return one record per movement set.

    Parameters
    ----------
    bench
        Load, moves and sensors.
    system
        Cylinder, lines and valves.
    gains, ahead
        Of the outer loops; a mass that is to be learnt stays at its start.
    """
    chambers = four_chambers(system.smallest_area, system.dead_volume)
    largest = np.abs(chambers.area).max()
    coefficient = system.flow_coefficient * np.abs(chambers.area) / largest
    lines = Lines(
        system.low_pressure,
        system.high_pressure,
        np.maximum(coefficient, system.least_flow_coefficient),
    )
    weights = ForceWeights(system.weight_compression, system.weight_switching, bench.machine.oil)
    state = np.zeros(_STATES)
    state[X] = bench.start
    state[PRESSURE:] = _start_pressures(bench.load, chambers, lines)
    sensors = settled_sensors(bench.start, state[PRESSURE:].copy())
    outer, memory = np.zeros(OUTER_STATES), np.array([0, 1])
    limits, fixed = force_range(chambers, lines), ahead._replace(adaptive=0.0)
    outer[REFERENCE] = bench.start
    if gains.k_i_pos > 0:  # what is not integrated cannot have learnt the load
        outer[INTEGRAL] = min(max(bench.load, limits[0]), limits[1]) / gains.k_p_vel
    valves, opened = shut_valves(), np.zeros((3, 2 * CHAMBERS))
    timing = timing_of(system.delay, system.ramp)

    def run_set(trace: FloatArray, begin: float) -> None:
        _run_ticks(
            state, sensors, outer, memory, valves, opened, bench.machine, bench.table, chambers,
            lines, timing, _ALONE, weights, gains, fixed, bench.sampling_period, bench.signals,
            bench.moves.pieces, bench.start, begin, bench.substeps, bench.random, trace,
        )  # fmt: skip

    return movement_sets(
        bench, state, CHAMBERS, CHAMBERS, run_set, lambda: int(valves.counters[0]), limits
    )


def _start_pressures(load: float, chambers: PistonChambers, lines: Lines) -> FloatArray:
    """Return pressures at which the load stands: all alike, but for the largest chamber's."""
    pressures = np.full(CHAMBERS, 0.5 * (lines.low + lines.high))
    pressures[0] += (load - float(chambers.area @ pressures)) / chambers.area[0]
    return pressures


@kernel
def _run_ticks(
    state: FloatArray,
    sensors: Sensed,
    outer: FloatArray,
    memory: IntArray,
    valves: ValveState,
    opened: FloatArray,
    machine: Machine,
    table: FloatArray,
    chambers: PistonChambers,
    lines: Lines,
    timing: Timing,
    sizes: FloatArray,
    weights: ForceWeights,
    gains: LoopGains,
    ahead: FeedforwardTuple,
    sampling_period: float,
    signals: SignalSettings,
    pieces: FloatArray,
    start: float,
    begin: float,
    substeps: int,
    random: np.random.Generator,
    trace: FloatArray,
) -> None:
    """Run one movement set and fill its trace; a tick is T_S,fast."""
    work, flow = step_room(len(state)), np.zeros(CHAMBERS)
    span = signals.sample_time
    h, limits = span / substeps, force_range(chambers, lines)
    law = outer_law(gains, ahead, sampling_period, signals.dead_zone, limits)
    for tick in range(len(trace)):
        now = begin + tick * span
        step, v_ref, _ = reference(tick * span, pieces)
        x_ref = start + step
        lag_references(outer, law, x_ref, v_ref)
        sense(sensors, state, PRESSURE, signals, random)
        if tick % signals.ticks == 0:
            position = sensors.history[0]
            velocity = differentiated(sensors.history, span)
            fed = acceleration_ahead(tick * span, pieces, ahead)
            force = force_reference(outer, law, position, velocity, fed)
            stop = stopped(memory[_STOPPED] > 0, x_ref - position, v_ref, signals)
            memory[_STOPPED] = 1 if stop else 0
            if not stop:
                memory[_STATE] = cheapest_state(
                    force, position, velocity, sensors.filtered[1:], memory[_STATE], chambers,
                    machine.stroke, lines, weights,
                )  # fmt: skip
            for i in range(CHAMBERS):
                high = float((memory[_STATE] >> i) & 1)
                switch(valves, 2 * i, 0.0 if stop else 1 - high, now, timing, random)
                switch(valves, 2 * i + 1, 0.0 if stop else high, now, timing, random)
        note(trace[tick], state, chambers, x_ref, v_ref, outer[FORCE], 1.0 - memory[_STOPPED])
        burden = burden_at(state[X], machine, table)
        for sub in range(substeps):
            openings(valves, sizes, now + sub * h, h, timing.ramp, opened)
            _step(state, opened, flow, chambers, machine, burden, lines, h, work)


@kernel
def _step(
    state: FloatArray,
    opened: FloatArray,
    flow: FloatArray,
    chambers: PistonChambers,
    machine: Machine,
    burden: Burden,
    lines: Lines,
    h: float,
    work: StepRoom,
) -> None:
    """Advance the system by the classical Runge-Kutta method."""
    ahead = work.ahead
    _rates(state, opened[0], flow, chambers, machine, burden, lines, work.k1)
    look_ahead(state, work.k1, 0.5 * h, ahead)
    _rates(ahead, opened[1], flow, chambers, machine, burden, lines, work.k2)
    look_ahead(state, work.k2, 0.5 * h, ahead)
    _rates(ahead, opened[1], flow, chambers, machine, burden, lines, work.k3)
    look_ahead(state, work.k3, h, ahead)
    _rates(ahead, opened[2], flow, chambers, machine, burden, lines, work.k4)
    settle(state, work, h, CHAMBERS, machine.stroke)


@kernel
def _rates(
    state: FloatArray,
    opened: FloatArray,
    flow: FloatArray,
    chambers: PistonChambers,
    machine: Machine,
    burden: Burden,
    lines: Lines,
    slope: FloatArray,
) -> None:
    """Fill the slopes of all states: chambers and piston."""
    slope[DRAWN] = slope[RETURNED] = slope[THROTTLING] = 0.0
    for i in range(CHAMBERS):
        pressure, coefficient = state[PRESSURE + i], lines.coefficient[i]
        to_low, to_high = lines.low - pressure, lines.high - pressure
        low = coefficient * opened[2 * i] * orifice(to_low, machine.transition_pressure)
        high = coefficient * opened[2 * i + 1] * orifice(to_high, machine.transition_pressure)
        flow[i] = low + high
        slope[DRAWN] += lines.high * high
        slope[RETURNED] += lines.low * low
        slope[THROTTLING] += to_low * low + to_high * high
    piston_rates(state, flow, chambers, machine, burden, slope)
