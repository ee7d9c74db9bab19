"""The decision: the cheapest of all 28² combinations (§2.3.2)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import FloatArray, kernel
from mptune.force.cost import side_costs
from mptune.force.estimator import (
    SIDE_A,
    SIDE_B,
    displaced,
    predict,
    stiffness_path,
)
from mptune.force.horizon import best_ahead

if TYPE_CHECKING:
    from mptune.force.search_space import SearchSpace
    from mptune.params.packed import ForceSettings


@kernel
def cheapest(
    wanted: float,
    force_a: FloatArray,
    cost_a: FloatArray,
    force_b: FloatArray,
    cost_b: FloatArray,
) -> tuple[int, int]:
    """Return the states of A and B with the least cost; the first of several equal ones."""
    best, best_a, best_b = np.inf, 0, 0
    for a in range(len(cost_a)):
        for b in range(len(cost_b)):
            total = abs(wanted - (force_a[a] - force_b[b])) + cost_a[a] + cost_b[b]  # Eq. 7
            if total < best:
                best, best_a, best_b = total, a, b
    return best_a, best_b


@kernel
def beyond_the_paper(settings: ForceSettings) -> bool:
    """Return whether anything is decided otherwise than by Eq. 7 and Eq. 8 as printed."""
    return (
        settings.error_width > 0
        or settings.path_loss > 0
        or settings.candidates > 0
        or settings.weight_common_mode > 0
        or settings.steady_state > 0
    )


@kernel
def decide(
    wanted: float,
    pressure_a: float,
    pressure_b: float,
    position: float,
    velocity: float,
    supplies: FloatArray,
    converters: FloatArray,
    present_a: int,
    present_b: int,
    space: SearchSpace,
    settings: ForceSettings,
) -> tuple[int, int]:
    """Return the valve states of A and B for the next sampling period.

    Parameters
    ----------
    wanted
        F_ref [N].
    pressure_a, pressure_b, position, velocity, supplies, converters
        Measured state; supplies ``(6,)``, converters ``(4,)``.
    present_a, present_b
        The states now.
    space, settings
        Search space and the controller's knowledge.

    Notes
    -----
    With ``delay_prediction`` the pressures are first carried through the valve delay, with the
    present states, and the decision is made from there. The paper's own decision keeps an
    arithmetic of its own, so that it stays what it was to the last bit.
    """
    states = len(space.first)
    lag = settings.delay_prediction
    if lag > 0:
        pressure_a = ahead_of_delay(
            SIDE_A, pressure_a, position, velocity, supplies, present_a, space, settings
        )
        pressure_b = ahead_of_delay(
            SIDE_B, pressure_b, position, velocity, supplies, present_b, space, settings
        )
        position += velocity * lag
    if beyond_the_paper(settings):
        return best_ahead(
            wanted, pressure_a, pressure_b, position, velocity, supplies, converters,
            present_a, present_b, space, settings,
        )  # fmt: skip
    force_a, cost_a = np.empty(states), np.empty(states)
    force_b, cost_b = np.empty(states), np.empty(states)
    side_costs(
        SIDE_A, pressure_a, position, velocity, supplies, converters, present_a, space, settings,
        force_a, cost_a,
    )  # fmt: skip
    side_costs(
        SIDE_B, pressure_b, position, velocity, supplies, converters, present_b, space, settings,
        force_b, cost_b,
    )  # fmt: skip
    return cheapest(wanted, force_a, cost_a, force_b, cost_b)


@kernel
def ahead_of_delay(
    side: int,
    pressure: float,
    position: float,
    velocity: float,
    supplies: FloatArray,
    state: int,
    space: SearchSpace,
    settings: ForceSettings,
) -> float:
    """Return the pressure after the valve delay with the present state [Pa]."""
    lag = settings.delay_prediction
    path = stiffness_path(side, position, velocity, lag, settings)
    return predict(
        pressure,
        supplies[space.first[state]],
        space.first_count[state],
        supplies[space.second[state]],
        space.second_count[state],
        displaced(side, velocity, settings),
        path,
        lag,
        settings,
    )
