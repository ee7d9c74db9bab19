"""What one side's valve state costs, and the force it will give (§2.3.2).

Every term of Eq. 7 but the force error is a sum over the two sides, so that S + S pressure
predictions serve all S² combinations, 28 + 28 in the paper.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import FloatArray, inlined_kernel, kernel
from mptune.force.estimator import SIDE_A, displaced, predict, stiffness_path
from mptune.force.search_space import search_space
from mptune.params.packed import BASE, MADE_BY, RESTS, SHARE
from mptune.plant.flow import orifice

if TYPE_CHECKING:
    from mptune.force.search_space import SearchSpace
    from mptune.params.packed import ForceSettings

_OUT_OF_RANGE = 1e6  # N, penalty of a pressure outside its limits


@inlined_kernel
def beyond_limits(after: float, settings: ForceSettings) -> float:
    """Return the penalty [N] of a pressure [Pa] outside its limits.

    It is fixed, or in proportion where ``weight_pressure`` is given: a fixed one leaves only
    states that hold the limits, useless ones too, where every useful state breaks them a little.
    """
    if settings.weight_pressure > 0:
        beyond = max(settings.pressure_min - after, after - settings.pressure_max)
        return settings.weight_pressure * beyond
    return _OUT_OF_RANGE


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
    """Fill force and cost ``(S,)`` [N] of every state of one side.

    Parameters
    ----------
    side
        ``SIDE_A`` or ``SIDE_B``.
    pressure
        Chamber pressure now [Pa].
    position, velocity
        Of the piston [m], [m/s].
    supplies
        ``(L,)`` pressures of the lines [Pa].
    converters
        ``(K,)`` converter positions, deviation from the centre, positive on filling [m].
    present
        The state now.
    """
    period = settings.sampling_period
    area = settings.area_a if side == SIDE_A else settings.area_b
    taken = displaced(side, velocity, settings)
    path = stiffness_path(side, position, velocity, period, settings)
    places = converter_places(converters, space.lines)
    for state in range(len(cost)):
        i, j = space.first[state], space.second[state]
        count_i, count_j = space.first_count[state], space.second_count[state]
        after = predict(
            pressure, supplies[i], count_i, supplies[j], count_j, taken, path, period, settings
        )
        loss, conversion = 0.0, 0.0
        if count_i > 0:
            loss, conversion = _port(count_i, supplies[i], pressure, after, places[i], settings)
        if count_j > 0:
            more = _port(count_j, supplies[j], pressure, after, places[j], settings)
            loss, conversion = loss + more[0], conversion + more[1]
        total = settings.weight_switching * space.switches[present, state]  # Eq. 7, second term
        total += settings.weight_loss * loss  # Eq. 7, third term
        total += settings.weight_converter * conversion  # Eq. 7, fourth term
        if after < settings.pressure_min or after > settings.pressure_max:
            total += beyond_limits(after, settings)
        force[state] = area * after
        cost[state] = total


@kernel
def converter_places(converters: FloatArray, lines: FloatArray) -> FloatArray:
    """Return where the converter stands that makes each line ``(L,)`` [m]; 0 where none does."""
    places = np.zeros(lines.shape[1])
    for line in range(len(places)):
        converter = int(lines[MADE_BY, line])
        if converter >= 0:
            places[line] = converters[converter]
    return places


@kernel
def _port(
    count: float,
    supply: float,
    before: float,
    after: float,
    place: float,
    settings: ForceSettings,
) -> tuple[float, float]:
    """Return E_loss [J] and Q_conv x³ [m⁶/s] of the valves towards one line."""
    scale = settings.flow_coefficient * count
    drop_now, drop_then = supply - before, supply - after
    flow_now = scale * orifice(drop_now, settings.transition_pressure)
    flow_then = scale * orifice(drop_then, settings.transition_pressure)
    loss = 0.5 * settings.sampling_period * (flow_now * drop_now + flow_then * drop_then)  # Eq. 8
    share = settings.predicted_share
    drawn = share * flow_then + (1 - share) * flow_now
    return loss, -drawn * place**3


@kernel
def force_limits(settings: ForceSettings) -> tuple[float, float]:
    """Return the least and the largest force [N] within the pressure limits."""
    low = settings.area_a * settings.pressure_min - settings.area_b * settings.pressure_max
    high = settings.area_a * settings.pressure_max - settings.area_b * settings.pressure_min
    return low, high


@kernel
def line_pressures(low: float, high: float, space: SearchSpace) -> FloatArray:
    """Return the pressures of all lines ``(L,)`` [Pa], the middle ones calculated (§2.2).

    ``low`` and ``high`` are the measured ones of the lowest and the highest line.
    """
    lines = space.lines
    supplies = np.empty(lines.shape[1])
    for i in range(len(supplies)):
        base = low if lines[RESTS, i] > 0 else lines[BASE, i]
        supplies[i] = base + lines[SHARE, i] * (high - base)
    return supplies


def supply_pressures(low: float, high: float) -> FloatArray:
    """Return the paper's six supply pressures ``(6,)`` [Pa], see ``line_pressures``."""
    return line_pressures(low, high, search_space())
