"""The trace of a system's run, tick by tick, and the neutral record made of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import FloatArray, kernel
from mptune.sim.record import BrokenLimit, Energies, RunRecord
from mptune.systems import cylinder as piston
from mptune.systems.cylinder import PRESSURE, PistonChambers, V, X, piston_force

if TYPE_CHECKING:
    from mptune.sim.moves import Moves

# Columns of a trace; chamber pressures and whatever pressures follow them stand behind.
X_REF, V_REF, POSITION, VELOCITY, F_REF, FORCE, ACTIVE, PRESSURES = range(8)


def new_trace(ticks: int, pressures: int) -> FloatArray:
    """Return an empty trace ``(T, 7 + P)``."""
    return np.zeros((ticks, PRESSURES + pressures))


@kernel
def note(
    row: FloatArray,
    state: FloatArray,
    chambers: PistonChambers,
    position_reference: float,
    velocity_reference: float,
    force_reference: float,
    active: float,
) -> None:
    """Write one tick down: references, piston and every pressure."""
    row[X_REF], row[V_REF] = position_reference, velocity_reference
    row[POSITION], row[VELOCITY] = state[X], state[V]
    row[F_REF], row[FORCE], row[ACTIVE] = force_reference, piston_force(state, chambers), active
    for i in range(len(row) - PRESSURES):
        row[PRESSURES + i] = state[PRESSURE + i]


def record_of(
    trace: FloatArray,
    moves: Moves,
    energy: FloatArray,
    switches: int,
    chambers: int,
    stroke: float,
    tick: float,
    begin: float,
    force_limits: tuple[float, float],
) -> RunRecord:
    """Return the record of one movement set; it looks at the trace and does not copy it.

    Parameters
    ----------
    trace
        ``(T, 7 + P)``.
    moves
        The reference.
    energy
        ``(7,)`` of the set [J], as ``mptune.systems.cylinder`` orders them.
    switches
        Valve switches in the set; 0 for a valve that is not switched.
    chambers
        How many of the pressures are chambers'.
    stroke
        Of the piston [m].
    tick
        Time between rows [s].
    begin
        When the set began [s].
    force_limits
        Least and largest force reference [N].
    """
    first = piston.DRAWN
    drawn, returned = float(energy[0]), float(energy[piston.RETURNED - first])
    position, slack = trace[:, POSITION], 1e-6
    at_end = (position <= slack) | (position >= stroke - slack)
    broken: tuple[BrokenLimit, ...] = ()
    if at_end.any():
        when = float(np.argmax(at_end)) * tick + begin
        broken = (BrokenLimit("the piston stands at its end", when),)
    return RunRecord(
        sample_time=tick,
        position_reference=trace[:, X_REF],
        velocity_reference=trace[:, V_REF],
        position=position,
        velocity=trace[:, VELOCITY],
        force_reference=trace[:, F_REF],
        force=trace[:, FORCE],
        active=trace[:, ACTIVE] > 0,
        ends=moves.ends,
        travel=moves.travel,
        energies=Energies(
            pumped=drawn,
            drawn=drawn,
            returned=returned,
            delivered=float(energy[piston.DELIVERED - first]),
            spent={
                "throttling": float(energy[piston.THROTTLING - first]),
                "compression": float(energy[piston.COMPRESSION - first]),
            },
        ),
        switches=switches,
        force_limits=force_limits,
        broken=broken,
        pressures=trace[:, PRESSURES : PRESSURES + chambers],
        commands=moves.commands,
    )
