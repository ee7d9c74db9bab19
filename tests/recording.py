"""mptune's own machine driven tick by tick from outside, by any controller.

The same kernels run in the same order as in ``mptune.sim.closed_loop.run_ticks``, noise and valve
delays drawn from the same source: with mptune's controller it is the simulation itself, with every
raw sample and every decision written down.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mptune.force.cost import force_limits, side_costs, supply_pressures
from mptune.force.estimator import SIDE_A, SIDE_B
from mptune.force.search_space import search_space, space_of
from mptune.params.pack import (
    pack_chambers,
    pack_estimator,
    pack_feedforward,
    pack_force,
    pack_gains,
    pack_machine,
    pack_sensors,
    pack_signals,
    pack_table,
)
from mptune.plant.supplies import accumulator_pressure
from mptune.signals.adaptive_mass import fed_mass
from mptune.signals.differentiator import differentiated
from mptune.signals.outer_loop import acceleration_ahead, lag_references, outer_law
from mptune.signals.trajectory import reference
from mptune.sim import closed_loop as loop
from mptune.sim.integrator import integrate, new_work
from mptune.sim.measure import measure
from mptune.sim.moves import moves_of
from mptune.verify.verify import cases_of, delays_of, new_memory

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
    law: object
    signals: object
    settings: object
    space: object
    moves: object
    random: np.random.Generator
    first: np.ndarray  # (12,) inputs before the first tick
    load: float  # N, which the integrator carries at the start
    more: object  # the chambers where there are more than two

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
    trace: np.ndarray  # (T, 16)


def rig_of(study, case, gains=None, feedforward=None):
    controller = study.study.controller
    machine = pack_machine(study, case.mass, case.oil_bulk_modulus, case.load_force)
    packed = pack_gains(gains or study.study.gains)
    ahead = pack_feedforward(
        feedforward or study.study.feedforward,
        controller.fast_sampling_period,
        study.uncertainty.mass,
    )
    settings = pack_force(study)
    memory = new_memory(study, machine, packed, study.study.verification.start, ahead)
    first = np.concatenate([[memory.filtered[0], 0.0, 0.0], memory.filtered])
    return Rig(
        study=study,
        memory=memory,
        machine=machine,
        table=pack_table(study),
        delays=delays_of(study, case.valve_delay),
        law=outer_law(
            packed,
            ahead,
            controller.sampling_period,
            controller.dead_zone,
            force_limits(settings),
        ),
        signals=pack_signals(controller, pack_estimator(study), pack_sensors(study.study.sensors)),
        settings=settings,
        space=space_of(study),
        moves=moves_of(study.study.manoeuvre),
        random=np.random.default_rng(case.seed),
        first=first,
        load=case.load_force,
        more=pack_chambers(study),
    )


def record_case(study, case, sets=1, **changes):
    """Return the recording of a case over so many movement sets, mptune's controller at work."""
    rig = rig_of(study, case, **changes)
    controller = Recorder(rig)
    trace = drive(rig, controller, sets)
    inputs, decisions = np.array(controller.inputs), np.array(controller.decisions)
    return Recording(rig.first, rig.load, inputs, decisions, trace)


class Recorder:
    """mptune's own controller as a unit that writes down what it sees and does."""

    def __init__(self, rig):
        self.rig, self.inputs, self.decisions = rig, [], []

    def start(self, first, load):
        pass  # the rig's memory stands at rest already

    def step(self, inputs):
        rig, outer, choice = self.rig, self.rig.memory.outer, self.rig.memory.choice
        x_ref, v_ref, a_ref = inputs[:3].tolist()
        lag_references(outer, rig.law, x_ref, v_ref)
        before = choice.copy()
        if len(self.inputs) % rig.signals.ticks == 0:
            loop._control(
                rig.memory,
                x_ref,
                v_ref,
                a_ref,
                rig.law,
                rig.signals,
                rig.settings,
                rig.space,
                rig.more,
            )
        decided = (outer[loop.FORCE], outer[loop.STOPPED], *choice)
        inside = (rig.memory.filtered, rig.memory.converters, rig.memory.history)
        self.inputs.append(inputs)
        self.decisions.append(np.concatenate([decided, before, *inside]))
        return decided


def drive(rig, unit, sets=1):
    """Return the trace ``(T, 16)`` of the machine under a unit, over so many movement sets.

    Noise and valve delays are drawn in the order of the simulator: nine samples in each tick, then
    one delay for each valve that switches. A unit has ``start(first, load)`` and ``step(inputs)``;
    the latter returns force reference, stopped, and the states of A and B.
    """
    memory, machine, signals = rig.memory, rig.machine, rig.signals
    tick_time = signals.sample_time
    width = loop.chamber_columns(machine.converters, len(memory.choice)).width
    work = new_work(memory.valves, rig.space.lines, rig.space.edge, len(memory.state), rig.more)
    trace = np.empty((sets * rig.ticks, width))
    unit.start(rig.first, rig.load)
    for row, (number, tick) in zip(trace, np.ndindex(sets, rig.ticks), strict=True):
        now = number * rig.ticks * tick_time + tick * tick_time
        step, v_ref, _ = reference(tick * tick_time, rig.moves.pieces)
        a_ref = acceleration_ahead(tick * tick_time, rig.moves.pieces, rig.law.ahead)
        x_ref = rig.start + step
        measure(memory, machine, signals, rig.settings, rig.law, v_ref, rig.random, rig.more)
        outputs = unit.step(np.concatenate([[x_ref, v_ref, a_ref], memory.raw[0]]))
        memory.outer[loop.FORCE], memory.outer[loop.STOPPED] = outputs[:2]
        memory.choice[:] = outputs[2:]
        if tick % signals.ticks == 0:
            loop._switch(memory, rig.space, now, rig.delays, rig.random)
        loop._record(row, memory, x_ref, v_ref, machine, rig.more)
        row[loop.FED_MASS] = fed_mass(memory.outer, rig.law.ahead)
        high = accumulator_pressure(memory.state[loop.OIL], machine)
        if high < machine.pump_on:
            memory.outer[loop.PUMPING] = 1.0
        elif high > machine.pump_off:
            memory.outer[loop.PUMPING] = 0.0
        integrate(
            memory.state, memory.energy, memory.valves, memory.outer[loop.PUMPING],
            machine, rig.table, rig.delays.ramp, now, tick_time, work, rig.more,
        )  # fmt: skip
    return trace


def extra_cost(study, decision, state_a, state_b):
    """Return what two states cost more than those decided on, and what the latter cost [N]."""
    settings, space = pack_force(study), search_space()
    velocity = differentiated(decision[HISTORY], study.study.controller.fast_sampling_period)
    filtered, position = decision[FILTERED], decision[HISTORY][0]
    supplies = supply_pressures(filtered[4], filtered[3])
    sides = []
    for side, before in ((SIDE_A, BEFORE_A), (SIDE_B, BEFORE_B)):
        force, cost = np.empty(len(space.first)), np.empty(len(space.first))
        side_costs(
            side, filtered[1 + side], position, velocity, supplies, decision[CONVERTERS],
            int(decision[before]), space, settings, force, cost,
        )  # fmt: skip
        sides.append((force, cost))
    (force_a, cost_a), (force_b, cost_b) = sides

    def total(a, b):
        return abs(decision[FORCE] - (force_a[a] - force_b[b])) + cost_a[a] + cost_b[b]

    least = total(int(decision[STATE_A]), int(decision[STATE_B]))
    return total(int(state_a), int(state_b)) - least, least


def first_case(study, mass):
    return next(case for case in cases_of(study) if case.mass == mass)
