"""The nonlinear machine's trace as a neutral record, with the limits that the machine has."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.params.packed import AREA
from mptune.plant import machine as plant
from mptune.sim import closed_loop as loop
from mptune.sim.record import BrokenLimit, Energies, RunRecord

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.params.packed import Machine, MoreChambers
    from mptune.sim.moves import Moves


def record_of(
    trace: FloatArray,
    moves: Moves,
    energy: FloatArray,
    switches: int,
    machine: Machine,
    tick: float,
    force_limits: tuple[float, float],
    begin: float = 0.0,
    busiest: int | None = None,
    more: MoreChambers | None = None,
) -> RunRecord:
    """Return the record of one movement set; it looks at the trace and does not copy it.

    Parameters
    ----------
    trace
        ``(T, 12 + K)``, see ``mptune.sim.closed_loop``.
    moves
        The reference.
    energy
        ``(8,)`` energies of the set [J], see ``mptune.plant.machine``.
    switches
        Valve switches in the set.
    machine
        The machine.
    tick
        Time between rows [s].
    force_limits
        Least and largest force reference [N].
    begin
        When the set began [s].
    busiest
        Switches of the busiest valve in the set; None where they were not counted.
    more
        The machine's chambers where there are more than two.
    """
    areas = [machine.area_a, -machine.area_b] if more is None else more.table[AREA]
    columns = loop.chamber_columns(machine.converters, len(areas)).pressures
    with np.errstate(invalid="ignore", over="ignore"):  # of a run that left the numbers
        force = areas[0] * trace[:, columns[0]]
        for area, column in zip(areas[1:], columns[1:], strict=True):
            force = force + area * trace[:, column]
    return RunRecord(
        sample_time=tick,
        position_reference=trace[:, loop.X_REF],
        velocity_reference=trace[:, loop.V_REF],
        position=trace[:, loop.POSITION],
        velocity=trace[:, loop.VELOCITY],
        force_reference=trace[:, loop.F_REF],
        force=force,
        active=trace[:, loop.ACTIVE] > 0,
        ends=moves.ends,
        travel=moves.travel,
        energies=energies_of(energy),
        switches=switches,
        force_limits=force_limits,
        broken=broken_limits(trace, machine, tick, begin),
        pressures=_pressures(trace, columns),
        own_figures=_converter_peak(trace, machine) if machine.converters else {},
        busiest=busiest,
        commands=moves.commands,
    )


def _pressures(trace: FloatArray, columns: list[int]) -> FloatArray:
    """Return the chambers' pressures, of two chambers without a copy."""
    first, last = columns[0], columns[-1] + 1
    if columns == list(range(first, last)):
        return trace[:, first:last]
    return trace[:, columns]


def _converters(trace: FloatArray, machine: Machine) -> FloatArray:
    return trace[:, loop.CONVERTER_1 : loop.CONVERTER_1 + machine.converters]


def _converter_peak(trace: FloatArray, machine: Machine) -> dict[str, float]:
    """Return how far a converter piston came from its centre, as a figure of the machine's own."""
    return {"converter_peak_mm": 1e3 * float(np.abs(_converters(trace, machine)).max())}


def energies_of(energy: FloatArray) -> Energies:
    """Return the machine's energies ``(8,)`` by where they came from and went."""
    values = [float(one) for one in energy]
    return Energies(
        pumped=values[plant.PUMP],
        drawn=values[plant.ACCUMULATOR],
        returned=values[plant.TANK],
        delivered=values[plant.PISTON],
        spent={
            "throttling": values[plant.THROTTLING],
            "converter friction": values[plant.CONVERTER_FRICTION],
            "compression": values[plant.COMPRESSION],
        },
    )


def broken_limits(
    trace: FloatArray, machine: Machine, tick: float, begin: float
) -> tuple[BrokenLimit, ...]:
    """Return the limits that a set breaks and when first, in the order of time."""
    slack = 1e-6
    converters = np.abs(_converters(trace, machine)).max(axis=1, initial=0.0)
    position = trace[:, loop.POSITION]
    empty = machine.accumulator_precharge * (1 + slack)
    tests = {
        "a converter piston stands at its end": converters >= machine.converter_travel - slack,
        "the piston stands at its end": (position <= slack) | (position >= machine.stroke - slack),
        "the accumulator is empty": trace[:, loop.HIGH_PRESSURE] <= empty,
    }
    broken = [
        BrokenLimit(name, float(np.argmax(hit)) * tick + begin)
        for name, hit in tests.items()
        if hit.any()
    ]
    return tuple(sorted(broken, key=lambda limit: limit.at))
