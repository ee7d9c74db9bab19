"""§7's figures from the trace of one movement set, and what went wrong in it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.plant import machine as plant
from mptune.sim import closed_loop as loop
from mptune.verify.result import SetFigures

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.params.pack import Machine
    from mptune.sim.moves import Moves

_DEVIATION = 0.2  # of the peak reference velocity: a larger one counts as a swing
_PERIOD = 0.25  # s: swings further apart are no oscillation
LIMIT_CYCLE_SWINGS = 8  # alternating swings in a row


def set_figures(
    trace: FloatArray,
    moves: Moves,
    energy: FloatArray,
    switches: int,
    machine: Machine,
    tick: float,
    force_limits: tuple[float, float],
) -> SetFigures:
    """Return the figures of one movement set.

    Parameters
    ----------
    trace
        ``(T, 15)``.
    moves
        The reference.
    energy
        ``(8,)`` energies of the set [J].
    switches
        Valve switches in the set.
    machine
        The machine.
    tick
        Time between rows [s].
    force_limits
        Least and largest force reference [N].
    """
    error = trace[:, loop.X_REF] - trace[:, loop.POSITION]
    velocity = trace[:, loop.VELOCITY]
    force = machine.area_a * trace[:, loop.CHAMBER_A] - machine.area_b * trace[:, loop.CHAMBER_B]
    force_error = (trace[:, loop.F_REF] - force) * trace[:, loop.ACTIVE]
    last = np.clip(np.rint(moves.ends / tick).astype(np.int64) - 1, 0, len(trace) - 1)
    travel = 1e3 * moves.travel
    given = energy[plant.ACCUMULATOR] + energy[plant.TANK]
    spent = energy[[plant.PISTON, plant.THROTTLING, plant.CONVERTER_FRICTION, plant.COMPRESSION]]
    chambers = trace[:, [loop.CHAMBER_A, loop.CHAMBER_B]]
    converters = trace[:, loop.CONVERTER_1 : loop.CONVERTER_1 + 4]
    at_limit = (trace[:, loop.F_REF] <= force_limits[0]) | (trace[:, loop.F_REF] >= force_limits[1])
    return SetFigures(
        performance_index_ms=1e3 * float(np.abs(error).max() / np.abs(velocity).max()),
        energy_loss_j_per_mm=float(energy[plant.ACCUMULATOR] - energy[plant.PISTON]) / travel,
        pump_loss_j_per_mm=float(energy[plant.PUMP] - energy[plant.PISTON]) / travel,
        force_error_integral_kn2s=float((force_error**2).sum()) * tick / 1e6,
        final_error_mm=1e3 * float(np.abs(error[last]).max()),
        peak_velocity_mm_s=1e3 * float(np.abs(velocity).max()),
        valve_switches=switches,
        converter_peak_mm=1e3 * float(np.abs(converters).max()),
        pressure_min_mpa=float(chambers.min()) / 1e6,
        pressure_max_mpa=float(chambers.max()) / 1e6,
        energy_residual=abs(float(given - spent.sum())) / max(abs(float(given)), 1.0),
        oscillation=longest_oscillation(velocity - trace[:, loop.V_REF], trace, tick),
        saturated_s=float(at_limit.sum()) * tick,
    )


def longest_oscillation(deviation: FloatArray, trace: FloatArray, tick: float) -> int:
    """Return the longest run of alternating large deviations from the velocity reference."""
    level = _DEVIATION * float(np.abs(trace[:, loop.V_REF]).max())
    large = np.flatnonzero(np.abs(deviation) > level)
    if len(large) == 0:
        return 0
    sign = np.sign(deviation[large])
    swing = np.flatnonzero(np.diff(sign) != 0)  # large deviations of both signs in turn
    gaps = (large[swing + 1] - large[swing]) * tick
    longest = run = 1
    for gap in gaps:
        run = run + 1 if gap <= _PERIOD else 1
        longest = max(longest, run)
    return longest


def first_broken_limit(
    trace: FloatArray, machine: Machine, tick: float, begin: float
) -> tuple[str, float]:
    """Return the limit that a set breaks first and when [s]; nothing and NaN where none is."""
    slack = 1e-6
    converters = np.abs(trace[:, loop.CONVERTER_1 : loop.CONVERTER_1 + 4]).max(axis=1)
    position = trace[:, loop.POSITION]
    tests = {
        "a converter piston stands at its end": converters >= machine.converter_travel - slack,
        "the piston stands at its end": (position <= slack) | (position >= machine.stroke - slack),
        "the accumulator is empty": trace[:, loop.HIGH_PRESSURE]
        <= machine.accumulator_precharge * (1 + slack),
    }
    broken = {
        name: float(np.argmax(hit)) * tick + begin for name, hit in tests.items() if hit.any()
    }
    if not broken:
        return "", float("nan")
    name = min(broken, key=lambda key: broken[key])
    return name, broken[name]
