"""What every look ahead of one decision shares, state by state, and the row that it fills.

The S states stand side by side in flat arrays, so that one loop serves them all at once; a state
without crossflow has a second port with no valves.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, kernel
from mptune.force.cost import beyond_limits, converter_places

if TYPE_CHECKING:
    from mptune.force.search_space import SearchSpace
    from mptune.params.packed import ForceSettings

BARRED = 1e30  # N, cost of a state that is not to be taken
# A row of states holds: force of the side [N]; what it costs beside the force error [N]; its half
# of the common-mode term, signed [N]; and the pressure that it leads to [Pa].
FORCE, COST, COMMON, PRESSURE = range(4)
ROW = 4
_Six = tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]


class Ports(NamedTuple):
    """State by state, each ``(S,)``."""

    shared: _Six  # supplies of both ports [Pa], their open valves, cubed converter positions [m³]
    scratch: _Six
    middle: float  # Pa, mid-supply pressure


@kernel
def ports_of(supplies: FloatArray, converters: FloatArray, space: SearchSpace) -> Ports:
    """Return the ports of every state.

    Parameters
    ----------
    supplies
        ``(L,)`` pressures of the lines [Pa].
    converters
        ``(K,)`` converter positions, positive on filling [m].
    """
    states = len(space.first)
    work = np.zeros((12, states))
    cubes = converter_places(converters, space.lines)
    for line in range(len(cubes)):
        cubes[line] = cubes[line] * (cubes[line] * cubes[line])
    for state in range(states):
        i, j = space.first[state], space.second[state]
        work[0, state], work[1, state] = supplies[i], supplies[j]
        work[2, state], work[3, state] = space.first_count[state], space.second_count[state]
        work[4, state], work[5, state] = cubes[i], cubes[j]
    middle = 0.5 * (supplies[0] + supplies[len(supplies) - 1])
    shared = (work[0], work[1], work[2], work[3], work[4], work[5])
    return Ports(shared, (work[6], work[7], work[8], work[9], work[10], work[11]), middle)


@kernel
def finish_row(
    area: float,
    present: int,
    middle: float,
    space: SearchSpace,
    settings: ForceSettings,
    row: FloatArray,
) -> float:
    """Complete a row from its pressures and the costs of its flows; return its least cost [N].

    Parameters
    ----------
    area
        Of the piston on this side [m²].
    present
        The state before: every valve that differs is a switch.
    middle
        Mid-supply pressure [Pa].
    row
        ``(4, S)``; pressures and costs of the flows in, everything out.
    """
    force, cost, common, pressure = row[FORCE], row[COST], row[COMMON], row[PRESSURE]
    switches = space.switches[present]
    least = BARRED
    half = 0.5 * settings.weight_common_mode
    for state in range(len(force)):
        after = pressure[state]
        total = settings.weight_switching * switches[state] + cost[state]
        if after < settings.pressure_min or after > settings.pressure_max:
            total += beyond_limits(after, settings)
        force[state] = area * after
        cost[state] = total
        common[state] = half * (after - middle)
        least = min(least, total)
    return least
