"""What every system is tried on: one load, the study's moves, its sensors and its stop logic."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.params.pack import pack_machine, pack_signals, pack_table
from mptune.plant.piston import burden_at
from mptune.signals.outer_loop import NO_LIMITS
from mptune.sim.moves import moves_of
from mptune.systems.cylinder import ENERGIES
from mptune.systems.trace import new_trace, record_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.arrays import FloatArray
    from mptune.params.packed import Machine, SignalSettings
    from mptune.params.study import ResolvedStudy
    from mptune.sim.moves import Moves
    from mptune.sim.record import RunRecord

SUBSTEPS = 10  # of the integration in one tick of T_S,fast


class LoadCase(NamedTuple):
    """One load, and how long it is moved."""

    mass: float  # kg
    oil_bulk_modulus: float  # Pa
    load_force: float  # N
    seed: int
    repeats: int  # movement sets
    substeps: int = SUBSTEPS


class LoadBench(NamedTuple):
    """A load with its moves, packed for the kernels."""

    machine: Machine
    table: FloatArray
    signals: SignalSettings
    moves: Moves
    start: float  # m
    load: float  # N, at the start
    ticks: int  # of one movement set
    sampling_period: float  # s
    repeats: int
    substeps: int
    random: np.random.Generator


def bench_of(study: ResolvedStudy, case: LoadCase) -> LoadBench:
    """Return the bench of one case."""
    machine = pack_machine(study, case.mass, case.oil_bulk_modulus, case.load_force)
    table, signals = pack_table(study), pack_signals(study.study.filtering)
    moves, period = moves_of(study.study.manoeuvre), study.study.controller.sampling_period
    start = study.study.verification.start
    return LoadBench(
        machine=machine,
        table=table,
        signals=signals,
        moves=moves,
        start=start,
        load=float(burden_at(start, machine, table).force),
        # Whole sampling periods, so that every set begins with a decision.
        ticks=signals.ticks * int(np.ceil(moves.duration / period - 1e-9)),
        sampling_period=period,
        repeats=case.repeats,
        substeps=case.substeps,
        random=np.random.default_rng(case.seed),
    )


def movement_sets(
    bench: LoadBench,
    state: FloatArray,
    chambers: int,
    pressures: int,
    run_set: Callable[[FloatArray, float], None],
    switches: Callable[[], int] = lambda: 0,
    force_limits: tuple[float, float] = NO_LIMITS,
) -> tuple[RunRecord, ...]:
    """Run the moves over and over and return a record of each set.

    Parameters
    ----------
    bench
        What is run.
    state
        ``(S,)`` of the system, which ``run_set`` carries on in place.
    chambers, pressures
        How many pressures are chambers', and how many there are in all.
    run_set
        Fills the trace of one set that begins at a time [s].
    switches
        Tells how often a valve was switched so far.
    force_limits
        Least and largest force reference [N].
    """
    records, tick = [], bench.signals.sample_time
    for number in range(bench.repeats):
        trace, begin = new_trace(bench.ticks, pressures), number * bench.ticks * tick
        energy, switched = state[ENERGIES].copy(), switches()
        run_set(trace, begin)
        record = record_of(
            trace,
            bench.moves,
            state[ENERGIES] - energy,
            switches() - switched,
            chambers,
            bench.machine.stroke,
            tick,
            begin,
            force_limits,
        )
        records.append(record)
        if not np.isfinite(trace[:, :6:5]).all():
            break
    return tuple(records)
