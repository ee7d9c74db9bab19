"""Closed loops of mptune's own simulator with every raw sample and every decision written down.

The same kernels run in the same order as in ``mptune.sim.closed_loop.run_ticks``, noise and valve
delays drawn from the same source, so that a recording is the simulation itself.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mptune.arrays import kernel
from mptune.force.search_space import search_space
from mptune.params.pack import (
    pack_feedforward,
    pack_force,
    pack_gains,
    pack_machine,
    pack_signals,
    pack_table,
)
from mptune.plant.supplies import accumulator_pressure
from mptune.signals.trajectory import reference
from mptune.signals.tustin import discretise
from mptune.sim import closed_loop as loop
from mptune.sim.moves import moves_of
from mptune.verify.verify import _delays, cases_of, new_memory

FORCE, STOPPED, STATE_A, STATE_B, BEFORE_A, BEFORE_B = range(6)
FILTERED, CONVERTERS, HISTORY = slice(6, 15), slice(15, 19), slice(19, 25)
DECISIONS = 25


class Rig(NamedTuple):
    """One machine with its controller, ready to run."""

    study: object
    memory: loop.Memory
    machine: object
    table: np.ndarray
    delays: loop.Delays
    gains: object
    law: object
    ahead: object
    signals: object
    settings: object
    space: object
    moves: object
    random: np.random.Generator
    first: np.ndarray  # (12,) inputs before the first tick
    load: float  # N, which the integrator carries at the start

    @property
    def start(self):
        return self.study.study.verification.start

    @property
    def ticks(self):
        """Ticks of one movement set, as ``verify`` counts them."""
        period = self.study.study.controller.sampling_period
        return self.signals.ticks * int(np.ceil(self.moves.duration / period - 1e-9))


class Recording(NamedTuple):
    """Raw inputs and decisions, tick by tick."""

    first: np.ndarray  # (12,)
    load: float
    inputs: np.ndarray  # (T, 12) in the order of mptune_inputs
    decisions: np.ndarray  # (T, 25) see the names above
    trace: np.ndarray  # (T, 15)


def rig_of(study, case, gains=None, feedforward=None):
    controller = study.study.controller
    machine = pack_machine(study, case.mass, case.oil_bulk_modulus, case.load_force)
    packed = pack_gains(gains or study.study.gains)
    memory = new_memory(study, machine, packed, study.study.verification.start)
    first = np.concatenate([[memory.filtered[0], 0.0, 0.0], memory.filtered])
    return Rig(
        study=study,
        memory=memory,
        machine=machine,
        table=pack_table(study),
        delays=_delays(study, case),
        gains=packed,
        law=discretise(packed, controller.sampling_period),
        ahead=pack_feedforward(
            feedforward or study.study.feedforward, controller.fast_sampling_period
        ),
        signals=pack_signals(controller),
        settings=pack_force(study),
        space=search_space(),
        moves=moves_of(study.study.manoeuvre),
        random=np.random.default_rng(case.seed),
        first=first,
        load=case.load_force,
    )


def record_case(study, case, sets=1, **changes):
    """Return the recording of a case over so many movement sets."""
    rig = rig_of(study, case, **changes)
    ticks = rig.ticks
    inputs, decisions = np.empty((sets * ticks, 12)), np.empty((sets * ticks, DECISIONS))
    trace = np.empty((sets * ticks, loop.COLUMNS))
    for number in range(sets):
        rows = slice(number * ticks, (number + 1) * ticks)
        _record_ticks(
            rig.memory, rig.machine, rig.table, rig.delays, rig.gains, rig.law, rig.ahead,
            rig.signals, rig.settings, rig.space, rig.moves.pieces, rig.start,
            number * ticks * rig.signals.sample_time, rig.random,
            inputs[rows], decisions[rows], trace[rows],
        )  # fmt: skip
    return Recording(rig.first, rig.load, inputs, decisions, trace)


def first_case(study, mass):
    return next(case for case in cases_of(study) if case.mass == mass)


@kernel
def lag_references(memory, ahead, x_ref, v_ref):
    outer = memory.outer
    outer[loop.REFERENCE] += (1 - ahead.reference_pole) * (x_ref - outer[loop.REFERENCE])
    outer[loop.VELOCITY_REFERENCE] += (1 - ahead.velocity_reference_pole) * (
        v_ref - outer[loop.VELOCITY_REFERENCE]
    )


@kernel
def advance_machine(memory, machine, table, ramp, now, tick_time, work):
    high = accumulator_pressure(memory.state[loop.OIL], machine)
    if high < machine.pump_on:
        memory.outer[loop.PUMPING] = 1.0
    elif high > machine.pump_off:
        memory.outer[loop.PUMPING] = 0.0
    loop._integrate(memory, machine, table, ramp, now, tick_time, work)


@kernel
def _record_ticks(
    memory, machine, table, delays, gains, law, ahead, signals, settings, space, pieces, start,
    begin, random, inputs, decisions, trace,
):  # fmt: skip
    tick_time = signals.sample_time
    work = loop.new_work(memory.valves)
    for tick in range(len(trace)):
        now = begin + tick * tick_time
        step, v_ref, a_ref = reference(tick * tick_time, pieces)
        x_ref = start + step
        lag_references(memory, ahead, x_ref, v_ref)
        loop._measure(memory, machine, signals, random)
        inputs[tick, 0], inputs[tick, 1], inputs[tick, 2] = x_ref, v_ref, a_ref
        inputs[tick, 3:] = memory.raw[0]
        row = decisions[tick]
        row[BEFORE_A], row[BEFORE_B] = memory.choice[0], memory.choice[1]
        if tick % signals.ticks == 0:
            loop._control(memory, x_ref, v_ref, a_ref, gains, law, ahead, signals, settings, space)
            loop._switch(memory, space, now, delays, random)
        row[FORCE], row[STOPPED] = memory.outer[loop.FORCE], memory.outer[loop.STOPPED]
        row[STATE_A], row[STATE_B] = memory.choice[0], memory.choice[1]
        row[6:15] = memory.filtered
        row[15:19] = memory.converters
        row[19:25] = memory.history
        loop._record(trace[tick], memory, x_ref, v_ref, machine)
        advance_machine(memory, machine, table, delays.ramp, now, tick_time, work)
