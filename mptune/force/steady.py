"""All S states of one side judged by the pressure at which the chamber settles (ref. 16).

At a steady velocity v the flow through the open valves is what the piston takes,

    Σ K_v n_i √(p_i − p) = A v,

and p follows from it for each state: the left side falls as p rises, so there is one. What the
chamber does on the way is left out, and with it the delay of the valves; a weight on the energy
that compression takes, V Δp²/(2 B̂), says that a change of pressure is not free.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mptune.arrays import FloatArray, kernel
from mptune.force.dynamic import smooth_root
from mptune.force.estimator import SIDE_A, displaced, stiffness
from mptune.force.ports import BARRED, COST, PRESSURE, Ports, finish_row

if TYPE_CHECKING:
    from mptune.force.search_space import SearchSpace
    from mptune.params.packed import ForceSettings

_HALVINGS = 32  # a bracket of some 10 MPa shrinks to some mPa


@kernel
def settle(
    side: int,
    pressure: float,
    position: float,
    velocity: float,
    present: int,
    ports: Ports,
    space: SearchSpace,
    settings: ForceSettings,
    row: FloatArray,
) -> float:
    """Fill the row ``(4, S)`` of one side once settled; return its least cost [N].

    Parameters
    ----------
    side
        ``SIDE_A`` or ``SIDE_B``.
    pressure, position, velocity
        Of the chamber [Pa] and of the piston [m], [m/s].
    present
        The state before.
    ports, space, settings
        What all looks ahead of one decision share.

    Notes
    -----
    A closed chamber settles at no pressure while the piston moves: the closed state is barred
    then, and keeps its pressure at rest.
    """
    states = row.shape[1]
    tr, scale = settings.transition_pressure, settings.flow_coefficient
    steep, bend = 1.5 / math.sqrt(tr), 0.5 / (tr * math.sqrt(tr))
    taken = displaced(side, velocity, settings)
    high_1, high_2, n_1, n_2, cube_1, cube_2 = ports.shared
    low, high, after = ports.scratch[0], ports.scratch[1], ports.scratch[2]
    for i in range(states):
        valves = max(n_1[i] + n_2[i], 1.0)
        root = taken / (scale * valves)
        reach = max(root * root, tr)  # at this drop the valves pass at least what is taken
        other = high_2[i] if n_2[i] > 0 else high_1[i]
        low[i] = min(high_1[i], other) - reach
        high[i] = max(high_1[i], other) + reach
    for _ in range(_HALVINGS):
        for i in range(states):
            p = 0.5 * (low[i] + high[i])
            flow = n_1[i] * smooth_root(high_1[i] - p, tr, steep, bend)
            flow += n_2[i] * smooth_root(high_2[i] - p, tr, steep, bend)
            more = scale * flow > taken  # the chamber still fills: it settles higher
            low[i], high[i] = p if more else low[i], high[i] if more else p
    stiff = stiffness(side, position, settings)
    period = settings.sampling_period
    for i in range(states):
        closed = n_1[i] == 0
        p = pressure if closed else 0.5 * (low[i] + high[i])
        flow_1 = scale * n_1[i] * smooth_root(high_1[i] - p, tr, steep, bend)
        flow_2 = scale * n_2[i] * smooth_root(high_2[i] - p, tr, steep, bend)
        loss = period * (flow_1 * (high_1[i] - p) + flow_2 * (high_2[i] - p))  # Eq. 8
        conversion = -(flow_1 * cube_1[i] + flow_2 * cube_2[i])
        cost = settings.weight_loss * loss + settings.weight_converter * conversion
        change = p - pressure
        cost += settings.weight_compression * (0.5 * change * change / stiff)  # V Δp²/(2 B̂)
        after[i] = p
        row[PRESSURE, i] = p
        row[COST, i] = cost
    if abs(velocity) > settings.rest_velocity:
        row[COST, 0] = BARRED
    area = settings.area_a if side == SIDE_A else settings.area_b
    return finish_row(area, present, ports.middle, space, settings, row)
