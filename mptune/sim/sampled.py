"""The linear closed loop as it runs: sampled at T_S, filtered at T_S,fast, with exact dead time.

A state estimator may stand in the filters' place, and acceleration and friction are fed forward as
on the machine; a mass that is learnt on line starts at the feed-forward's. Between samples the
plant of Eq. 15 is advanced exactly: the force reference is held over T_S and reaches the plant
after valve and computation, at whatever instant within a fast tick that is. The median counts as
one sample. A constant load force is carried by the integrator from the start and so cancels; dead
zone and stop logic, which are not linear, are left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from mptune.arrays import FloatArray, frozen, kernel
from mptune.interop import Drawn
from mptune.loops.family import time_constants_at
from mptune.params.pack import pack_estimator, pack_feedforward, pack_filters, pack_gains
from mptune.params.packed import NO_ESTIMATOR, Plant
from mptune.signals.adaptive_mass import fed_mass, learn_mass, start_learning
from mptune.signals.differentiator import WEIGHTS, differentiated, remember
from mptune.signals.estimator import estimate
from mptune.signals.outer_loop import (
    NO_LIMITS,
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
from mptune.sim.commanded import commanded_ticks
from mptune.sim.judge import performance_index
from mptune.sim.linear_machine import move_on, stride_of
from mptune.sim.moves import moves_of
from mptune.strict import strict
from mptune.summary import Summarised

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd

    from mptune.params.controller import Feedforward, Gains
    from mptune.params.packed import FeedforwardTuple, LoopGains, MeasurementPath, StateEstimator
    from mptune.params.study import ResolvedStudy
    from mptune.sim.moves import Moves

DIVERGED = 20.0  # times the longest move, from which a loop is said to run away


@dataclass(frozen=True, repr=False)
class LinearMove(Summarised, Drawn):
    """One machine's movement set under the sampled linear controller.

    Attributes
    ----------
    mass_kg, valve_delay_s, oil_bulk_modulus_pa
        The machine; the delay is the mean of the valve's plus the largest of computation.
    stable
        Whether the movement ended near its reference instead of growing without bound.
    performance_index_ms
        Peak position error over peak velocity, §7.2; NaN where not stable, and of commanded speeds.
    time, reference, position, velocity, force
        ``(T,)`` traces at T_S,fast in SI; ``force`` is F_ref.
    """

    drawings: ClassVar[Mapping[str, str]] = {"moves": "mptune.figures.moves:move_traces"}

    mass_kg: float
    valve_delay_s: float
    oil_bulk_modulus_pa: float
    stable: bool
    performance_index_ms: float
    time: FloatArray
    reference: FloatArray
    position: FloatArray
    velocity: FloatArray
    force: FloatArray

    @property
    def badness(self) -> float:
        """Performance index [ms]; infinite where the loop is not stable."""
        return self.performance_index_ms if self.stable else float("inf")

    @property
    def headline(self) -> str:
        """The machine and its index."""
        index = (
            f"linear-check index {self.performance_index_ms:.4g} ms"
            if self.stable
            else "not stable"
        )
        return (
            f"Linear move of {self.mass_kg / 1e3:g} t, oil {self.oil_bulk_modulus_pa / 1e6:g} MPa, "
            f"valve delay {1e3 * self.valve_delay_s:g} ms: {index}"
        )

    def _drawn_with(self, _drawing: str) -> tuple[Any, ...]:
        return ((self,),)

    def json(self) -> dict[str, Any]:
        """Return machine and outcome, traces left out; the index keeps §7's unit.

        It is called the linear-check index, which is not the nonlinear machine's performance index
        and not the linear tracking index that the tuner makes small.
        """
        return strict(
            {
                "mass_kg": self.mass_kg,
                "valve_delay_s": self.valve_delay_s,
                "oil_bulk_modulus_pa": self.oil_bulk_modulus_pa,
                "stable": self.stable,
                "linear_check_index_ms": self.performance_index_ms,
            }
        )

    def to_pandas(self) -> pd.DataFrame:
        """Return the traces in SI, units in the columns, over time [s]."""
        import pandas as pd

        columns = {
            "reference_m": self.reference,
            "position_m": self.position,
            "velocity_m_s": self.velocity,
            "force_n": self.force,
        }
        return pd.DataFrame(columns, pd.Index(self.time, name="time_s"))


def linear_moves(
    study: ResolvedStudy, gains: Gains | None = None, feedforward: Feedforward | None = None
) -> tuple[LinearMove, ...]:
    """Run the study's movement set on each of its verification machines, linear.

    The time constants of pressure follow from Eq. 4 and Eq. 12 at the start position.

    Parameters
    ----------
    study
        The study.
    gains, feedforward
        What controls the machines; the study's own where None.
    """
    machine = study.study
    gains = gains or machine.gains
    moves = moves_of(machine.manoeuvre)
    path = pack_filters(machine.filtering)
    ahead = pack_feedforward(
        feedforward or machine.feedforward, path.sample_time, study.uncertainty.mass
    )
    estimator = pack_estimator(study)
    period = machine.controller.sampling_period
    ticks = round(moves.duration / path.sample_time)
    results = []
    for mass in machine.verification.masses:
        for pair in machine.verification.delay_ranges():
            delay = sum(pair) / 2 + machine.valves.computation_delay[1]
            for modulus in machine.verification.oil_bulk_moduli:
                tau_a, tau_b = time_constants_at(study, modulus, machine.verification.start)
                held = delay + period / 2
                plant = Plant(mass, held, tau_a, tau_b, machine.share_a)
                traces = run_linear(
                    plant, pack_gains(gains), path, period, moves.pieces, ahead, ticks, estimator
                )
                results.append(_judge(mass, delay, modulus, path.sample_time, moves, traces))
    return tuple(results)


def _judge(
    mass: float,
    delay: float,
    modulus: float,
    sample_time: float,
    moves: Moves,
    traces: FloatArray,
) -> LinearMove:
    wanted, position, velocity, force = traces
    limit = DIVERGED * moves.reach
    judged = ~commanded_ticks(moves.commands, sample_time, len(position))
    stable = bool(np.isfinite(traces).all() and np.abs(position).max() <= limit)
    index = float("nan")
    if stable and judged.any():
        index = 1e3 * performance_index((wanted - position)[judged], velocity[judged])
    return LinearMove(
        mass_kg=mass,
        valve_delay_s=delay,
        oil_bulk_modulus_pa=modulus,
        stable=stable,
        performance_index_ms=index,
        time=frozen(sample_time * np.arange(len(position))),
        reference=frozen(wanted),
        position=frozen(position),
        velocity=frozen(velocity),
        force=frozen(force),
    )


@kernel
def run_linear(
    plant: Plant,
    gains: LoopGains,
    path: MeasurementPath,
    period: float,
    pieces: FloatArray,
    ahead: FeedforwardTuple,
    ticks: int,
    estimator: StateEstimator = NO_ESTIMATOR,
    load: float = 0.0,
) -> FloatArray:
    """Return reference, position, velocity and F_ref at each fast tick, ``(4, T)``.

    Parameters
    ----------
    plant, gains, path
        The plant, whose delay holds T_S/2 for the hold, the gains, and the measurement path at
        T_S,fast.
    period
        T_S [s].
    pieces
        ``(P, 7)`` the reference, see ``mptune.signals.trajectory``.
    ahead
        Feed-forward.
    ticks
        Number T of fast ticks.
    estimator
        The state estimator; the filters of ``path`` without one.
    load
        A load force that sets in at time 0 [N]; against positive motion, as in Eq. 1.
    """
    fast, pole = path.sample_time, path.filter_pole
    every = round(period / fast)
    delay = plant.delay - period / 2  # valve and computation
    whole = int(delay / fast + 1e-9)
    within = max(delay - whole * fast, 0.0)  # of a tick, where a new reference arrives
    whole_tick = stride_of(plant, fast)
    before_it, after_it = stride_of(plant, within), stride_of(plant, fast - within)
    law = outer_law(gains, ahead, period, 0.0, NO_LIMITS)
    commands = np.zeros(ticks // every + 2)
    traces = np.empty((4, ticks))
    state = np.zeros(4)  # side A, side B, velocity, position
    outer, history = np.zeros(OUTER_STATES), np.zeros(len(WEIGHTS))
    start_learning(outer, ahead, 0.0)
    share = plant.share_a
    last, last_force, applied = 0.0, 0.0, 0.0
    for tick in range(ticks):
        r, v_ref, _ = reference(tick * fast, pieces)
        lag_references(outer, law, r, v_ref)
        remember(history, pole * history[0] + (1 - pole) * last)  # median: one sample late
        if estimator.mass > 0:
            estimate(outer, estimator, fast, last, last_force, v_ref, fed_mass(outer, ahead))
        if ahead.adaptive > 0:
            learn_mass(outer, ahead, last_force, v_ref)
        outer[LAST_VELOCITY_REFERENCE] = v_ref
        last = state[3]
        last_force = share * state[0] + (1 - share) * state[1]
        if tick % every == 0:
            position, measured = history[0], differentiated(history, fast)
            if estimator.mass > 0:
                position, measured = outer[POSITION_HEARD], outer[VELOCITY_HEARD]
            fed = acceleration_ahead(tick * fast, pieces, ahead)
            commands[tick // every] = force_reference(outer, law, position, measured, fed)
        traces[0, tick], traces[1, tick] = r, state[3]
        traces[2, tick], traces[3, tick] = state[2], outer[FORCE]
        if tick >= whole and (tick - whole) % every == 0:
            move_on(state, plant, applied, before_it)
            applied = commands[(tick - whole) // every]
            move_on(state, plant, applied, after_it)
        else:
            move_on(state, plant, applied, whole_tick)
        state[3] -= load * fast * fast / (2 * plant.mass)
        state[2] -= load * fast / plant.mass
    return traces
