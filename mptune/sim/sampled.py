"""The linear closed loop as it runs: sampled at T_S, filtered at T_S,fast, with exact dead time.

Between samples the plant of Eq. 15 is advanced exactly: the force reference is held over T_S and
reaches the plant after valve and computation, at whatever instant within a fast tick that is. The
median counts as one sample. A constant load force is carried by the integrator from the start and
so cancels; dead zone and stop logic, which are not linear, are left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, frozen, kernel
from mptune.interop import Drawn
from mptune.loops.family import time_constants_at
from mptune.params.pack import (
    FeedforwardTuple,
    LoopGains,
    MeasurementPath,
    pack_feedforward,
    pack_filters,
    pack_gains,
)
from mptune.signals.trajectory import reference
from mptune.signals.tustin import discretise
from mptune.sim.moves import moves_of
from mptune.strict import strict
from mptune.summary import Summarised

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd

    from mptune.params.controller import Feedforward, Gains
    from mptune.params.study import ResolvedStudy

_DIVERGED = 20.0  # times the longest move


class SampledPlant(NamedTuple):
    """One linear machine."""

    mass: float  # kg
    delay: float  # s, valve and computation, the hold not counted
    tau_a: float  # s
    tau_b: float  # s
    share_a: float  # -


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
        Peak position error over peak velocity, §7.2; NaN where not stable.
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
    def headline(self) -> str:
        """The machine and its index."""
        index = f"index {self.performance_index_ms:.4g} ms" if self.stable else "not stable"
        return (
            f"Linear move of {self.mass_kg / 1e3:g} t, oil {self.oil_bulk_modulus_pa / 1e6:g} MPa, "
            f"valve delay {1e3 * self.valve_delay_s:g} ms: {index}"
        )

    def _drawn_with(self, _drawing: str) -> tuple[Any, ...]:
        return ((self,),)

    def json(self) -> dict[str, Any]:
        """Return machine and verdict, traces left out; the index keeps §7's unit."""
        return strict(
            {
                "mass_kg": self.mass_kg,
                "valve_delay_s": self.valve_delay_s,
                "oil_bulk_modulus_pa": self.oil_bulk_modulus_pa,
                "stable": self.stable,
                "performance_index_ms": self.performance_index_ms,
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
    path = pack_filters(machine.controller)
    ahead = pack_feedforward(feedforward or machine.feedforward, path.sample_time)
    period = machine.controller.sampling_period
    ticks = round(moves.duration / path.sample_time)
    results = []
    for mass in machine.verification.masses:
        for pair in machine.verification.delay_ranges():
            delay = sum(pair) / 2 + machine.valves.computation_delay[1]
            for modulus in machine.verification.oil_bulk_moduli:
                tau_a, tau_b = time_constants_at(study, modulus, machine.verification.start)
                plant = SampledPlant(mass, delay, tau_a, tau_b, machine.cylinder.share_a)
                traces = run_linear(
                    plant, pack_gains(gains), path, period, moves.pieces, ahead, ticks
                )
                results.append(_judge(mass, delay, modulus, path.sample_time, moves.reach, traces))
    return tuple(results)


def _judge(
    mass: float,
    delay: float,
    modulus: float,
    sample_time: float,
    reach: float,
    traces: FloatArray,
) -> LinearMove:
    wanted, position, velocity, force = traces
    limit = _DIVERGED * reach
    stable = bool(np.isfinite(traces).all() and np.abs(position).max() < limit)
    index = float("nan")
    if stable:
        index = 1e3 * float(np.abs(wanted - position).max() / np.abs(velocity).max())
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
def _advance(state: FloatArray, force: float, plant: SampledPlant, step: float) -> None:
    """Advance side A, side B, velocity and position exactly under a constant force reference."""
    mean_once, mean_twice = 0.0, 0.0
    for side in range(2):
        share = plant.share_a if side == 0 else 1 - plant.share_a
        tau = plant.tau_a if side == 0 else plant.tau_b
        gap = state[side] - force
        factor = np.exp(-step / tau) if tau > 0 else 0.0
        faded = tau * (1 - factor)
        mean_once += share * (force * step + gap * faded)
        mean_twice += share * (force * step * step / 2 + gap * tau * (step - faded))
        state[side] = force + gap * factor
    state[3] += step * state[2] + mean_twice / plant.mass
    state[2] += mean_once / plant.mass


@kernel
def run_linear(
    plant: SampledPlant,
    gains: LoopGains,
    path: MeasurementPath,
    period: float,
    pieces: FloatArray,
    ahead: FeedforwardTuple,
    ticks: int,
) -> FloatArray:
    """Return reference, position, velocity and F_ref at each fast tick, ``(4, T)``.

    Parameters
    ----------
    plant, gains, path
        The machine, the gains, and the measurement path at T_S,fast.
    period
        T_S [s].
    pieces
        ``(P, 7)`` the reference, see ``mptune.signals.trajectory``.
    ahead
        Feed-forward.
    ticks
        Number T of fast ticks.
    """
    fast, pole = path.sample_time, path.filter_pole
    every = round(period / fast)
    whole = int(plant.delay / fast + 1e-9)
    within = max(plant.delay - whole * fast, 0.0)  # of a tick, where a new reference arrives
    law = discretise(gains, period)
    commands = np.zeros(ticks // every + 2)
    traces = np.empty((4, ticks))
    state = np.zeros(4)  # side A, side B, velocity, position
    history = np.zeros(6)  # filtered positions, newest first
    before, applied, given = 0.0, 0.0, 0.0
    lag1, lag2, integral, last_error = 0.0, 0.0, 0.0, 0.0
    lagged, lagged_velocity = 0.0, 0.0
    for tick in range(ticks):
        r, v_ref, a_ref = reference(tick * fast, pieces)
        lagged = ahead.reference_pole * lagged + (1 - ahead.reference_pole) * r
        kept = ahead.velocity_reference_pole
        lagged_velocity = kept * lagged_velocity + (1 - kept) * v_ref
        for tap in range(5, 0, -1):
            history[tap] = history[tap - 1]
        history[0] = pole * history[1] + (1 - pole) * before  # median: one sample late
        before = state[3]
        if tick % every == 0:
            measured = 0.0
            for tap in range(6):
                measured += (5.0, 3.0, 1.0, -1.0, -3.0, -5.0)[tap] * history[tap]
            measured /= 35 * fast  # Eq. 23
            error = lagged - history[0]
            shaped = law.b0 * error + lag1
            lag1 = law.b1 * error - law.a1 * shaped + lag2
            lag2 = law.b2 * error - law.a2 * shaped
            integral += law.integral * (error + last_error)
            last_error = error
            wanted = lagged_velocity + shaped + integral - measured
            given = gains.k_p_vel * wanted + ahead.acceleration_mass * a_ref
            commands[tick // every] = given
        traces[0, tick], traces[1, tick] = r, state[3]
        traces[2, tick], traces[3, tick] = state[2], given
        if tick >= whole and (tick - whole) % every == 0:
            _advance(state, applied, plant, within)
            applied = commands[(tick - whole) // every]
            _advance(state, applied, plant, fast - within)
        else:
            _advance(state, applied, plant, fast)
    return traces
