"""The cheapest combination of the states of four chambers.

Its cost is that of ``mptune.force.horizon`` with as many chambers as there are::

    J = ρ(F_ref − Σ ±A_i p̂_i) + W_cm |mean p̂_i − p_mid| + Σ cost of chamber i's state
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.arrays import FloatArray, IntArray, kernel
from mptune.force.horizon import counted
from mptune.force.ports import BARRED, COMMON, COST, FORCE

if TYPE_CHECKING:
    from mptune.params.packed import ForceSettings

_FOUR = 4


@kernel
def cheapest_of_four(
    wanted: float, settings: ForceSettings, rows: FloatArray, choice: IntArray
) -> None:
    """Put the cheapest combination of four rows into ``choice``; the first of several equal ones.

    What is skipped is skipped by a bound: force error and common mode cost nothing at least.
    """
    states, width = rows.shape[2], settings.error_width
    least = rows[_FOUR - 2, COST].min() + rows[_FOUR - 1, COST].min()
    best = BARRED
    for a in range(states):
        for b in range(states):
            cost_ab = rows[0, COST, a] + rows[1, COST, b]
            if cost_ab + least >= best:
                continue
            force_ab = rows[0, FORCE, a] + rows[1, FORCE, b]
            common_ab = rows[0, COMMON, a] + rows[1, COMMON, b]
            for c in range(states):
                for d in range(states):
                    force_cd = rows[2, FORCE, c] + rows[3, FORCE, d]
                    common = common_ab + (rows[2, COMMON, c] + rows[3, COMMON, d])
                    total = counted(wanted - (force_ab + force_cd), width)
                    total += 0.5 * abs(common)  # a row's is half of its pressure's
                    total += cost_ab + (rows[2, COST, c] + rows[3, COST, d])  # Eq. 7
                    if total < best:
                        best = total
                        choice[0], choice[1], choice[2], choice[3] = a, b, c, d
