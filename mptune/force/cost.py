"""What one side's valve state costs, and the force it will give (§2.3.2).

Every term of Eq. 7 but the force error is a sum over the two sides, so that 28 + 28 pressure
predictions serve all 28² combinations.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import FloatArray, kernel
from mptune.force.estimator import SIDE_A, displaced, predict, stiffness_path
from mptune.plant.flow import orifice

if TYPE_CHECKING:
    from mptune.force.search_space import SearchSpace
    from mptune.params.packed import ForceSettings

_OUT_OF_RANGE = 1e6  # N, penalty of a pressure outside its limits
_CONVERTERS = 4


@kernel
def side_costs(
    side: int,
    pressure: float,
    position: float,
    velocity: float,
    supplies: FloatArray,
    converters: FloatArray,
    present: int,
    space: SearchSpace,
    settings: ForceSettings,
    force: FloatArray,
    cost: FloatArray,
) -> None:
    """Fill force and cost ``(28,)`` [N] of every state of one side.

    Parameters
    ----------
    side
        ``SIDE_A`` or ``SIDE_B``.
    pressure
        Chamber pressure now [Pa].
    position, velocity
        Of the piston [m], [m/s].
    supplies
        ``(6,)`` supply pressures [Pa].
    converters
        ``(4,)`` converter positions, deviation from the centre, positive on filling [m].
    present
        The state now.
    """
    period = settings.sampling_period
    area = settings.area_a if side == SIDE_A else settings.area_b
    taken = displaced(side, velocity, settings)
    path = stiffness_path(side, position, velocity, period, settings)
    for state in range(len(cost)):
        i, j = space.first[state], space.second[state]
        count_i, count_j = space.first_count[state], space.second_count[state]
        after = predict(
            pressure, supplies[i], count_i, supplies[j], count_j, taken, path, period, settings
        )
        loss, conversion = 0.0, 0.0
        if count_i > 0:
            loss, conversion = _port(i, count_i, pressure, after, supplies, converters, settings)
        if count_j > 0:
            more = _port(j, count_j, pressure, after, supplies, converters, settings)
            loss, conversion = loss + more[0], conversion + more[1]
        total = settings.weight_switching * space.switches[present, state]  # Eq. 7, second term
        total += settings.weight_loss * loss  # Eq. 7, third term
        total += settings.weight_converter * conversion  # Eq. 7, fourth term
        if after < settings.pressure_min or after > settings.pressure_max:
            total += _OUT_OF_RANGE
        force[state] = area * after
        cost[state] = total


@kernel
def _port(
    supply: int,
    count: float,
    before: float,
    after: float,
    supplies: FloatArray,
    converters: FloatArray,
    settings: ForceSettings,
) -> tuple[float, float]:
    """Return E_loss [J] and Q_conv x³ [m⁶/s] of the valves towards one supply."""
    scale = settings.flow_coefficient * count
    drop_now, drop_then = supplies[supply] - before, supplies[supply] - after
    flow_now = scale * orifice(drop_now, settings.transition_pressure)
    flow_then = scale * orifice(drop_then, settings.transition_pressure)
    loss = 0.5 * settings.sampling_period * (flow_now * drop_now + flow_then * drop_then)  # Eq. 8
    converter = supply - 1
    if not 0 <= converter < _CONVERTERS:
        return loss, 0.0
    share = settings.predicted_share
    drawn = share * flow_then + (1 - share) * flow_now
    return loss, -drawn * converters[converter] ** 3


@kernel
def force_limits(settings: ForceSettings) -> tuple[float, float]:
    """Return the least and the largest force [N] within the pressure limits."""
    low = settings.area_a * settings.pressure_min - settings.area_b * settings.pressure_max
    high = settings.area_a * settings.pressure_max - settings.area_b * settings.pressure_min
    return low, high


@kernel
def supply_pressures(low: float, high: float) -> FloatArray:
    """Return the six supply pressures ``(6,)``, the middle ones calculated (§2.2)."""
    supplies = np.empty(6)
    for i in range(6):
        supplies[i] = low + i / 5.0 * (high - low)
    return supplies
