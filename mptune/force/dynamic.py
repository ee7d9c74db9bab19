"""All S states of one side carried through one sampling period by Eq. 5, side by side."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mptune.arrays import FloatArray, kernel
from mptune.force.estimator import SIDE_A, STEPS, displaced, stiffness_path
from mptune.force.ports import COST, PRESSURE, Ports, finish_row

if TYPE_CHECKING:
    from mptune.force.search_space import SearchSpace
    from mptune.params.packed import ForceSettings


@kernel
def smooth_root(difference: float, transition: float, steep: float, bend: float) -> float:
    """Return ``mptune.plant.flow.orifice`` [Pa^0.5] without branch or division.

    Both of its halves are computed and one is taken, so that many states fit into one instruction.

    Parameters
    ----------
    difference, transition
        As there [Pa].
    steep, bend
        3/(2 √p_tr) and 1/(2 p_tr^1.5).
    """
    size = abs(difference)
    root = math.sqrt(size)  # Eq. 2
    cubic = difference * (steep - bend * size)
    signed = root if difference > 0 else -root
    return signed if size >= transition else cubic


@kernel
def look_ahead(
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
    """Fill the row ``(4, S)`` of one side after T_S; return its least cost [N].

    Parameters
    ----------
    side
        ``SIDE_A`` or ``SIDE_B``.
    pressure, position, velocity
        At the beginning of the period [Pa], [m], [m/s]; velocity and supplies are held.
    present
        The state before.
    ports, space, settings
        What all looks ahead of one decision share.

    Notes
    -----
    The flows at the end of a Heun step are those at the beginning of the next: losses along the
    path and Q_conv need no flow that Eq. 5 does not.
    """
    states = row.shape[1]
    tr, scale = settings.transition_pressure, settings.flow_coefficient
    steep, bend = 1.5 / math.sqrt(tr), 0.5 / (tr * math.sqrt(tr))
    period = settings.sampling_period
    taken = displaced(side, velocity, settings)
    path = stiffness_path(side, position, velocity, period, settings)
    step = period / STEPS
    high_1, high_2, n_1, n_2, cube_1, cube_2 = ports.shared
    start_1, start_2, root_1, root_2, lost, after = ports.scratch
    for i in range(states):
        after[i], lost[i] = pressure, 0.0
        start_1[i] = smooth_root(high_1[i] - pressure, tr, steep, bend)
        start_2[i] = smooth_root(high_2[i] - pressure, tr, steep, bend)
        root_1[i], root_2[i] = start_1[i], start_2[i]
    for k in range(STEPS):
        stiff, stiffer = path[k], path[k + 1]
        for i in range(states):
            p = after[i]
            flow_1, flow_2 = n_1[i] * root_1[i], n_2[i] * root_2[i]
            slope_1 = stiff * (scale * (flow_1 + flow_2) - taken)
            ahead = p + step * slope_1
            flow = n_1[i] * smooth_root(high_1[i] - ahead, tr, steep, bend)
            flow += n_2[i] * smooth_root(high_2[i] - ahead, tr, steep, bend)
            slope_2 = stiffer * (scale * flow - taken)
            q = p + 0.5 * step * (slope_1 + slope_2)  # Eq. 5
            then_1 = smooth_root(high_1[i] - q, tr, steep, bend)
            then_2 = smooth_root(high_2[i] - q, tr, steep, bend)
            power = flow_1 * (high_1[i] - p) + flow_2 * (high_2[i] - p)
            power += n_1[i] * then_1 * (high_1[i] - q) + n_2[i] * then_2 * (high_2[i] - q)
            lost[i] += power
            after[i], root_1[i], root_2[i] = q, then_1, then_2
    pressures, costs = row[PRESSURE], row[COST]
    along = settings.path_loss > 0
    share = settings.predicted_share
    for i in range(states):
        scale_1, scale_2 = scale * n_1[i], scale * n_2[i]
        now_1, now_2 = scale_1 * start_1[i], scale_2 * start_2[i]
        then_1, then_2 = scale_1 * root_1[i], scale_2 * root_2[i]
        drop_1, drop_2 = high_1[i] - after[i], high_2[i] - after[i]
        ends = now_1 * (high_1[i] - pressure) + then_1 * drop_1
        ends += now_2 * (high_2[i] - pressure) + then_2 * drop_2
        steps = 0.5 * step * (scale * lost[i])  # Eq. 8 over each of Eq. 5's steps
        loss = steps if along else 0.5 * period * ends  # Eq. 8
        drawn_1 = share * then_1 + (1 - share) * now_1
        drawn_2 = share * then_2 + (1 - share) * now_2
        conversion = -(drawn_1 * cube_1[i] + drawn_2 * cube_2[i])
        pressures[i] = after[i]
        costs[i] = settings.weight_loss * loss + settings.weight_converter * conversion
    area = settings.area_a if side == SIDE_A else settings.area_b
    return finish_row(area, present, ports.middle, space, settings, row)
