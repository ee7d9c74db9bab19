"""The decision for a machine of four chambers: a look ahead of each, and one combination step.

A machine of two has kernels of its own, which begin with the paper's.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import FloatArray, IntArray, kernel
from mptune.force.combination import cheapest_of_four
from mptune.force.estimator import SIDE_A, SIDE_B
from mptune.force.horizon import row_of
from mptune.force.ports import FORCE, ROW, ports_of
from mptune.force.select import ahead_of_delay
from mptune.params.packed import AREA

if TYPE_CHECKING:
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
    rows = rows_of_chambers(
        pressures, position, velocity, supplies, converters, choice, space, more
    )
    cheapest_of_four(wanted, more.settings[0], rows, choice)


@kernel
def rows_of_chambers(
    pressures: FloatArray,
    position: float,
    velocity: float,
    supplies: FloatArray,
    converters: FloatArray,
    choice: IntArray,
    space: SearchSpace,
    more: MoreChambers,
) -> FloatArray:
    """Return the rows of all chambers ``(C, 4, S)``, see ``mptune.force.ports``; forces signed."""
    ports, states = ports_of(supplies, converters, space), len(space.first)
    rows = np.empty((len(choice), ROW, states))
    for i in range(len(choice)):
        settings, side = more.settings[i], SIDE_A if more.table[AREA, i] > 0 else SIDE_B
        lag, pressure = settings.delay_prediction, pressures[i]
        if lag > 0:
            pressure = ahead_of_delay(
                side, pressure, position, velocity, supplies, choice[i], space, settings
            )
        row_of(
            side, pressure, position + velocity * lag, velocity, choice[i], ports, space, settings,
            rows[i],
        )  # fmt: skip
        if side == SIDE_B:
            for state in range(states):
                rows[i, FORCE, state] = -rows[i, FORCE, state]
    return rows
