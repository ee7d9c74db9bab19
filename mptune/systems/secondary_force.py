"""Secondary control of a four-chamber cylinder: which of 16 line states gives the force.

Each chamber stands on one of two lines. At a velocity v its pressure settles at that of its line
less what the valve takes, p = p_line − (A v/K)² with the sign of the flow; the state is chosen by

    J = |F_ref − Σ A_i p_i| + W_comp Σ V_i (p_i − p_i,now)²/(2B) + W_sw N_sw

The pressures are taken as settled at once, so that the force errs while they change.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import kernel
from mptune.systems.cylinder import PistonChambers, volume_of
from mptune.systems.switching import ones

if TYPE_CHECKING:
    from mptune.arrays import FloatArray

CHAMBERS = 4
STATES = 2**CHAMBERS  # bit i: chamber i stands on the high line
AREAS = (8.0, -4.0, 2.0, -1.0)  # of the smallest, positive where pressure extends


class Lines(NamedTuple):
    """The two lines and the valves between them and the chambers."""

    low: float  # Pa
    high: float
    coefficient: FloatArray  # (4,) m³/(s Pa^0.5)


class ForceWeights(NamedTuple):
    """What the decision weighs beside the error of the force [N]."""

    compression: float  # N/J
    switching: float  # N
    bulk: float  # Pa, of the oil as believed


def four_chambers(smallest: float, dead: float) -> PistonChambers:
    """Return four chambers of areas 8:4:2:1 [m²], each with a dead volume [m³] and no hose."""
    return PistonChambers(smallest * np.array(AREAS), np.full(CHAMBERS, dead), np.zeros(CHAMBERS))


@kernel
def settled_pressure(line: float, area: float, velocity: float, coefficient: float) -> float:
    """Return the pressure of a chamber on a line [Pa]; an extending area draws flow at v > 0."""
    drop = area * velocity / coefficient
    return max(line - math.copysign(drop * drop, drop), 0.0)


@kernel
def cheapest_state(
    wanted: float,
    position: float,
    velocity: float,
    pressures: FloatArray,
    present: int,
    chambers: PistonChambers,
    stroke: float,
    lines: Lines,
    weights: ForceWeights,
) -> int:
    """Return the line state of least cost.

    Parameters
    ----------
    wanted
        F_ref [N].
    position, velocity, pressures
        As measured; pressures ``(4,)``.
    present
        The state now.
    chambers, stroke, lines, weights
        The cylinder and what is weighed.
    """
    settled, stored = np.empty((CHAMBERS, 2)), np.empty((CHAMBERS, 2))
    for i in range(CHAMBERS):
        volume = volume_of(position, i, chambers, stroke)
        for high in range(2):
            line = lines.high if high else lines.low
            pressure = settled_pressure(line, chambers.area[i], velocity, lines.coefficient[i])
            settled[i, high] = chambers.area[i] * pressure
            stored[i, high] = volume * (pressure - pressures[i]) ** 2 / (2 * weights.bulk)
    best, chosen = np.inf, present
    for state in range(STATES):
        force, spent = 0.0, 0.0
        for i in range(CHAMBERS):
            high = (state >> i) & 1
            force += settled[i, high]
            spent += stored[i, high]
        # A chamber that changes lines moves two valves.
        cost = abs(wanted - force) + weights.compression * spent
        cost += 2 * weights.switching * ones(state ^ present)
        if cost < best:
            best, chosen = cost, state
    return chosen


@kernel
def force_range(chambers: PistonChambers, lines: Lines) -> tuple[float, float]:
    """Return the least and the largest force of all states at rest [N]."""
    least, largest = 0.0, 0.0
    for area in chambers.area:
        least += area * (lines.low if area > 0 else lines.high)
        largest += area * (lines.high if area > 0 else lines.low)
    return least, largest
