"""Gains proven on the nonlinear machine: the study's moves on each of its machines (§6, §7)."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import frozen
from mptune.errors import Fault, InputError
from mptune.force.cost import force_limits
from mptune.force.search_space import space_of
from mptune.params.pack import (
    pack_estimator,
    pack_feedforward,
    pack_force,
    pack_gains,
    pack_machine,
    pack_sensors,
    pack_signals,
    pack_table,
)
from mptune.params.valve_states import states_by_kind
from mptune.progress import silent
from mptune.sim import closed_loop as loop
from mptune.sim.judge import LIMIT_CYCLE_SWINGS, SATURATED, set_figures
from mptune.sim.machine_record import record_of
from mptune.sim.moves import moves_of
from mptune.verify.at_rest import new_memory
from mptune.verify.result import CaseResult, CaseStatus, VerifyResult

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.params.controller import Feedforward, Gains
    from mptune.params.packed import (
        FeedforwardTuple,
        ForceSettings,
        LoopGains,
        Machine,
        SignalSettings,
    )
    from mptune.params.section import Range
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.sim.judge import SetFigures
    from mptune.sim.moves import Moves
    from mptune.sim.record import BrokenLimit


class Case(NamedTuple):
    """One machine to verify on."""

    mass: float
    valve_delay: Range
    oil_bulk_modulus: float
    load_force: float
    seed: int


def cases_of(study: ResolvedStudy) -> tuple[Case, ...]:
    """Return every machine that the study's ``[verification]`` names."""
    asked = study.study.verification
    axes = (asked.masses, asked.delay_ranges(), asked.oil_bulk_moduli, asked.load_forces)
    return tuple(Case(*one) for one in product(*axes, asked.seeds))


def verify(
    study: ResolvedStudy,
    gains: Gains | None = None,
    feedforward: Feedforward | None = None,
    progress: Progress = silent,
) -> VerifyResult:
    """Run the study's moves on each of its machines with the nonlinear simulator.

    Parameters
    ----------
    study
        The study.
    gains, feedforward
        What the controller uses; the study's own where None.
    progress
        Told of the stage ``"verify"``.

    Raises
    ------
    InputError
        If the sampling period is not longer than the valve delay (Table 2), or if the movement set
        does not end where it began and is to be repeated.
    """
    from joblib import Parallel, delayed

    gains = gains or study.study.gains
    feedforward = feedforward or study.study.feedforward
    _check(study)
    cases = cases_of(study)
    jobs = (delayed(run_case)(study, case, gains, feedforward) for case in cases)
    results = []
    for result in Parallel(n_jobs=-1, prefer="threads", return_as="generator")(jobs):
        results.append(result)
        progress("verify", len(results) / len(cases))
    return VerifyResult(study, gains, feedforward, tuple(results))


def _check(study: ResolvedStudy) -> None:
    asked = study.study.verification
    for number, (_, longest) in enumerate(asked.delay_ranges()):
        check_delay(study, f"verification.valve_delays[{number + 1}]", longest)
    check_repeats(study, "verification.repeats", asked.repeats)


def check_delay(study: ResolvedStudy, key: str, longest: float) -> None:
    """Refuse a valve delay [s] that the sampling period does not exceed.

    The steady-state decision looks at no instant, so that it may be slower than its valves.

    Raises
    ------
    InputError
        Naming ``key``.
    """
    period = study.study.controller.sampling_period
    if longest >= period and study.study.controller.force_model == "dynamic":
        raise InputError(
            study.name,
            Fault(
                key,
                f"{1e3 * longest:g} ms",
                f"is not below the sampling period, {1e3 * period:g} ms, "
                "which Table 2 asks to be longer than the valve delay",
                "lengthen controller.sampling_period or take faster valves",
            ),
        )


def check_repeats(study: ResolvedStudy, key: str, repeats: int) -> None:
    """Refuse to repeat a movement set that does not end where it began.

    Raises
    ------
    InputError
        Naming ``key``.
    """
    net = sum(move.net_distance for move in study.study.manoeuvre)
    if repeats > 1 and abs(net) > 1e-9:
        raise InputError(
            study.name,
            Fault(
                key,
                str(repeats),
                f"repeats moves that end {1e3 * net:g} mm from where they began",
                f"add a move back, or set {key.rsplit('.', 1)[-1]} = 1",
            ),
        )


class Rig(NamedTuple):
    """A machine, its controller and its moves, packed for the closed loop."""

    machine: Machine
    table: FloatArray
    delays: loop.Delays
    gains: LoopGains
    ahead: FeedforwardTuple
    signals: SignalSettings
    settings: ForceSettings
    moves: Moves


def rig_of(study: ResolvedStudy, case: Case, gains: Gains, feedforward: Feedforward) -> Rig:
    """Return one machine of a study with its controller and moves."""
    controller = study.study.filtering
    return Rig(
        machine=pack_machine(study, case.mass, case.oil_bulk_modulus, case.load_force),
        table=pack_table(study),
        delays=delays_of(study, case.valve_delay),
        gains=pack_gains(gains),
        ahead=pack_feedforward(
            feedforward, controller.fast_sampling_period, study.uncertainty.mass
        ),
        signals=pack_signals(controller, pack_estimator(study), pack_sensors(study.study.sensors)),
        settings=pack_force(study),
        moves=moves_of(study.study.manoeuvre),
    )


def run_case(
    study: ResolvedStudy,
    case: Case,
    gains: Gains,
    feedforward: Feedforward,
    *,
    while_stable: bool = False,
) -> CaseResult:
    """Run one machine through its movement sets; memory does not grow with their number.

    ``while_stable`` ends it after the first set that is not: no later one would mend its status.
    """
    rig = rig_of(study, case, gains, feedforward)
    random = np.random.default_rng(case.seed)
    repeats = study.study.verification.repeats
    return run_rig(study, case, rig, random, repeats, while_stable=while_stable)


def run_rig(
    study: ResolvedStudy,
    case: Case,
    rig: Rig,
    random: np.random.Generator,
    repeats: int,
    *,
    while_stable: bool = False,
) -> CaseResult:
    """Run a rig through ``repeats`` movement sets; ``case`` only names the machine."""
    machine, signals, moves = rig.machine, rig.signals, rig.moves
    start = study.study.verification.start
    # Whole sampling periods, so that every set begins with a decision.
    period = rig.settings.sampling_period
    ticks = signals.ticks * int(np.ceil(moves.duration / period - 1e-9))
    memory = new_memory(study, machine, rig.gains, start, rig.ahead)
    limits = force_limits(rig.settings)
    space = space_of(study)
    trace = np.empty((ticks, loop.CONVERTER_1 + machine.converters))
    sets: list[SetFigures] = []
    broken: BrokenLimit | None = None
    for number in range(repeats):
        before, counted = memory.energy.copy(), memory.valves.counters.copy()
        begin = number * ticks * signals.sample_time
        loop.run_ticks(
            memory,
            machine,
            rig.table, rig.delays, rig.gains, rig.ahead, signals, rig.settings, space,
            moves.pieces,
            start, begin, random, trace,
        )  # fmt: skip
        energy, switched = memory.energy - before, memory.valves.counters - counted
        record = record_of(
            trace, moves, energy, int(switched[0]), machine, signals.sample_time, limits, begin,
            int(switched[2:].max()),
        )  # fmt: skip
        finite = bool(np.isfinite(trace).all())
        if not finite:
            break
        if broken is None and record.broken:
            broken = record.broken[0]
        if number > 0 or repeats == 1:
            sets.append(set_figures(record))
        if while_stable and _status(sets, broken, finite=True) is not CaseStatus.STABLE:
            break
    return CaseResult(
        mass_kg=case.mass,
        valve_delay_s=case.valve_delay,
        oil_bulk_modulus_pa=case.oil_bulk_modulus,
        load_force_n=case.load_force,
        seed=case.seed,
        status=_status(sets, broken, finite=finite),
        broken=broken.name if broken else "",
        broken_at_s=broken.at if broken else float("nan"),
        sets=tuple(sets),
        record=record,
        traces=frozen(trace),
        states=tuple(map(len, states_by_kind(study.study.edge_rule))),
    )


def _status(sets: list[SetFigures], broken: BrokenLimit | None, *, finite: bool) -> CaseStatus:
    if not finite:
        return CaseStatus.NOT_FINITE
    if any(one.oscillation >= LIMIT_CYCLE_SWINGS for one in sets):
        return CaseStatus.LIMIT_CYCLE
    if broken:
        return CaseStatus.LIMIT_BROKEN
    if any(one.saturated_s >= SATURATED for one in sets):
        return CaseStatus.SATURATED
    return CaseStatus.STABLE


def delays_of(study: ResolvedStudy, valve_delay: Range) -> loop.Delays:
    """Return pure delays: valve delay less its ramp, plus the largest computational delay."""
    valves = study.study.valves
    extra = valves.computation_delay[1] - valves.ramp
    least, largest = (max(delay + extra, 0.0) for delay in valve_delay)
    return loop.Delays(least, largest, valves.ramp)
