"""The decision for a machine of four chambers: a look ahead of each, and one combination step.

Two periods ahead it is as ``mptune.force.horizon`` has it, the n cheapest combinations in the place
of pairs. A machine of two has kernels of its own, which begin with the paper's.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import FloatArray, IntArray, inlined_kernel, kernel, lending_kernel
from mptune.force.combination import FOUR, cheapest_of_four, least_of_four
from mptune.force.estimator import SIDE_A, SIDE_B
from mptune.force.horizon import row_of
from mptune.force.ports import BARRED, FORCE, PRESSURE, ROW, ports_of
from mptune.force.select import ahead_of_delay
from mptune.params.packed import AREA

if TYPE_CHECKING:
    from mptune.force.ports import Ports
    from mptune.force.search_space import SearchSpace
    from mptune.params.packed import MoreChambers


@kernel
def decide_of_chambers(
    wanted: float,
    pressures: FloatArray,
    position: float,
    velocity: float,
    supplies: FloatArray,
    converters: FloatArray,
    choice: IntArray,
    space: SearchSpace,
    more: MoreChambers,
) -> None:
    """Replace the chambers' states ``choice`` ``(4,)`` by those of the next sampling period.

    Parameters
    ----------
    wanted
        F_ref [N].
    pressures
        ``(4,)`` of the chambers [Pa].
    position, velocity, supplies, converters
        As ``mptune.force.select.decide`` has them.
    choice
        The states now in, the cheapest out; of several equal ones the first.
    space, more
        Search space of every chamber, and the chambers.
    """
    settings, ports = more.settings[0], ports_of(supplies, converters, space)
    rows = np.empty((len(choice), ROW, len(space.first)))
    lag = settings.delay_prediction
    for i in range(len(choice)):
        pressure = pressures[i]
        if lag > 0:
            pressure = ahead_of_delay(
                _side(i, more), pressure, position, velocity, supplies, choice[i], space,
                more.settings[i],
            )  # fmt: skip
        _fill(
            i, pressure, position + velocity * lag, velocity, choice[i], ports, space, more,
            rows[i],
        )  # fmt: skip
    steps = int(settings.candidates)
    costs = np.empty(max(steps, 1))
    found = np.zeros((len(costs), FOUR), np.int64)
    number = cheapest_of_four(wanted, settings.error_width, rows, costs, found)
    if number == 0:
        return
    best = 0
    if steps > 0:
        later = position + velocity * lag + velocity * settings.sampling_period
        best = _best_ahead(wanted, later, velocity, rows, costs[:number], found, ports, space, more)
    choice[:] = found[best]


@kernel
def _best_ahead(
    wanted: float,
    position: float,
    velocity: float,
    rows: FloatArray,
    costs: FloatArray,
    found: IntArray,
    ports: Ports,
    space: SearchSpace,
    more: MoreChambers,
) -> int:
    """Return which of the cheapest combinations is so with the best of a second period."""
    width, states = more.settings[0].error_width, rows.shape[2]
    where = np.full((FOUR, states), -1)  # which of ``met`` follows a state
    met, number = np.empty((FOUR * min(len(costs), states), ROW, states)), 0
    after = np.empty((FOUR, ROW, states))
    least, best = BARRED, 0
    for k in range(len(costs)):
        for i in range(FOUR):
            state = found[k, i]
            if where[i, state] < 0:
                pressure = rows[i, PRESSURE, state]
                _fill(i, pressure, position, velocity, state, ports, space, more, met[number])
                where[i, state], number = number, number + 1
            after[i] = met[where[i, state]]
        total = costs[k] + least_of_four(wanted, width, after, costs[k], least)
        if total < least:
            least, best = total, k
    return best


@inlined_kernel
def _side(chamber: int, more: MoreChambers) -> int:
    return SIDE_A if more.table[AREA, chamber] > 0 else SIDE_B


@lending_kernel
def _fill(
    chamber: int,
    pressure: float,
    position: float,
    velocity: float,
    present: int,
    ports: Ports,
    space: SearchSpace,
    more: MoreChambers,
    row: FloatArray,
) -> None:
    """Fill the row ``(4, S)`` of one chamber, see ``mptune.force.ports``; forces signed."""
    side = _side(chamber, more)
    row_of(side, pressure, position, velocity, present, ports, space, more.settings[chamber], row)
    if side == SIDE_B:
        for state in range(row.shape[1]):
            row[FORCE, state] = -row[FORCE, state]
