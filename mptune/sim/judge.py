"""§7's figures of merit of one movement set, from its neutral record, and what went wrong in it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol, TypeVar

import numpy as np

from mptune.sim.commanded import commanded_ticks, following

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mptune.arrays import FloatArray
    from mptune.sim.record import RunRecord

_DEVIATION = 0.2  # of the peak reference velocity: a larger one counts as a swing
_YEAR = 365.25 * 86400.0  # s
_PERIOD = 0.25  # s: swings further apart are no oscillation
LIMIT_CYCLE_SWINGS = 8  # alternating swings in a row
SATURATED = 0.05  # s in one set: a force reference that stands at its limit for as long


class Judged(Protocol):
    """A run of one machine, as far as runs are ranked."""

    @property
    def mass_kg(self) -> float:
        """Effective inertia [kg]."""

    @property
    def badness(self) -> float:
        """Performance index [ms]; infinite where the run is not stable."""


_Run = TypeVar("_Run", bound=Judged)


@dataclass(frozen=True)
class SetFigures:
    """§7's figures of one movement set, in §7's units; see ``mptune.sim.merit`` for their names.

    What the machine has not is NaN.
    """

    performance_index_ms: float  # peak position error over peak velocity; not of a commanded speed
    energy_loss_j_per_mm: float  # energy drawn less energy delivered, per travel
    pump_loss_j_per_mm: float  # energy pumped less energy delivered (§7.1)
    force_error_integral_kn2s: float  # while the force is controlled
    final_error_mm: float  # largest at the end of a rest
    peak_velocity_mm_s: float
    valve_switches: int
    converter_peak_mm: float = field(default=np.nan, kw_only=True)
    pressure_min_mpa: float
    pressure_max_mpa: float
    energy_residual: float  # what the energies fail to close by, over the energy put in
    oscillation: int  # longest run of alternating large velocity deviations
    saturated_s: float  # time with the force reference at its limit
    busiest_valve_per_s: float = np.nan  # switches of the valve that switches most
    velocity_error_mm_s: float = np.nan  # rms while a speed is commanded, as the next two
    velocity_lag_ms: float = np.nan
    stop_overshoot_mm: float = np.nan


def set_figures(record: RunRecord) -> SetFigures:
    """Return the figures of one movement set."""
    tick, travel = record.sample_time, 1e3 * record.travel or np.nan  # no way, no figure per way
    last = np.clip(np.rint(record.ends / tick).astype(np.int64) - 1, 0, len(record.position) - 1)
    low, high = record.force_limits
    at_limit = (record.force_reference <= low) | (record.force_reference >= high)
    pressures = np.array([np.nan]) if record.pressures is None else record.pressures
    error, velocity = record.error, record.velocity
    duration, followed = tick * len(error), following(record)
    return SetFigures(
        performance_index_ms=1e3 * _index_of_moves(record),
        energy_loss_j_per_mm=record.energies.loss / travel,
        pump_loss_j_per_mm=record.energies.pump_loss / travel,
        force_error_integral_kn2s=float((record.force_error**2).sum()) * tick / 1e6,
        final_error_mm=1e3 * float(np.abs(error[last]).max()),
        peak_velocity_mm_s=1e3 * float(np.abs(velocity).max()),
        valve_switches=record.switches,
        pressure_min_mpa=float(pressures.min()) / 1e6,
        pressure_max_mpa=float(pressures.max()) / 1e6,
        energy_residual=record.energies.residual,
        oscillation=longest_oscillation(velocity, record.velocity_reference, tick),
        saturated_s=float(at_limit.sum()) * tick,
        busiest_valve_per_s=np.nan if record.busiest is None else record.busiest / duration,
        velocity_error_mm_s=1e3 * followed.error,
        velocity_lag_ms=1e3 * followed.lag,
        stop_overshoot_mm=1e3 * followed.overshoot,
        **record.own_figures,
    )


def _index_of_moves(record: RunRecord) -> float:
    """Return the index [s] of all moves to a place; NaN where there are none."""
    moves = ~commanded_ticks(record.commands, record.sample_time, len(record.position))
    if not record.travel or not moves.any():
        return np.nan
    return performance_index(record.error[moves], record.velocity[moves])


def per_year(per_second: float, duty: float) -> float:
    """Return how often in a year something happens that happens so often per second at work.

    Parameters
    ----------
    per_second
        While the machine works [1/s].
    duty
        Share of the year in which it does.
    """
    return per_second * duty * _YEAR


def performance_index(error: FloatArray, velocity: FloatArray) -> float:
    """Return the peak position error over the peak velocity [s], §7.2.

    Infinite where nothing moved that should have, and NaN where nothing had to.
    """
    largest, fastest = float(np.abs(error).max()), float(np.abs(velocity).max())
    if fastest == 0:
        return float("inf") if largest > 0 else float("nan")
    return largest / fastest


def longest_oscillation(
    velocity: FloatArray, velocity_reference: FloatArray, sample_time: float
) -> int:
    """Return the longest run of alternating large deviations from the velocity reference.

    Velocities are ``(T,)`` [m/s], ``sample_time`` apart [s].
    """
    level = _DEVIATION * float(np.abs(velocity_reference).max())
    deviation = velocity - velocity_reference
    large = np.flatnonzero(np.abs(deviation) > level)
    if len(large) == 0:
        return 0
    sign = np.sign(deviation[large])
    swing = np.flatnonzero(np.diff(sign) != 0)  # large deviations of both signs in turn
    gaps = (large[swing + 1] - large[swing]) * sample_time
    longest = run = 1
    for gap in gaps:
        run = run + 1 if gap <= _PERIOD else 1
        longest = max(longest, run)
    return longest


def worst_per_mass(runs: Iterable[_Run]) -> tuple[_Run, ...]:
    """Return for each mass the first run that is not stable, or that with the worst index."""
    worst: dict[float, _Run] = {}
    for run in runs:
        known = worst.get(run.mass_kg)
        if known is None or run.badness > known.badness:
            worst[run.mass_kg] = run
    return tuple(worst.values())
