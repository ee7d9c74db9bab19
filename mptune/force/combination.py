"""The cheapest combinations of the states of four chambers.

Their cost is that of ``mptune.force.horizon`` with as many chambers as there are::

    J = ρ(F_ref − Σ ±A_i p̂_i) + W_cm |mean p̂_i − p_mid| + Σ cost of chamber i's state

What is skipped is skipped by a bound, as there: force error and common mode cost nothing at least.
"""

from __future__ import annotations

from mptune.arrays import FloatArray, IntArray, inlined_kernel, kernel
from mptune.force.horizon import counted
from mptune.force.ports import BARRED, COMMON, COST, FORCE

FOUR = 4


@inlined_kernel
def _cost_of(
    wanted: float, width: float, rows: FloatArray, a: int, b: int, c: int, d: int
) -> float:
    """Return J of one combination [N]."""
    force = rows[0, FORCE, a] + rows[1, FORCE, b] + (rows[2, FORCE, c] + rows[3, FORCE, d])
    common = rows[0, COMMON, a] + rows[1, COMMON, b] + (rows[2, COMMON, c] + rows[3, COMMON, d])
    total: float = counted(wanted - force, width)
    total += 0.5 * abs(common)  # a row's is half of its pressure's
    cost = rows[0, COST, a] + rows[1, COST, b] + (rows[2, COST, c] + rows[3, COST, d])
    total += cost  # Eq. 7
    return total


@kernel
def cheapest_of_four(
    wanted: float, width: float, rows: FloatArray, costs: FloatArray, found: IntArray
) -> int:
    """Fill costs ``(n,)`` and states ``(n, 4)`` of the cheapest combinations, cheapest first.

    Of several equal ones the first comes first. Returned is how many there are.
    """
    states, number, worst = rows.shape[2], 0, BARRED  # of a full list, its dearest
    least = rows[FOUR - 2, COST].min() + rows[FOUR - 1, COST].min()
    for a in range(states):
        for b in range(states):
            if rows[0, COST, a] + rows[1, COST, b] + least >= worst:
                continue
            for c in range(states):
                for d in range(states):
                    total = _cost_of(wanted, width, rows, a, b, c, d)
                    if not total < worst:
                        continue
                    place = number if number < len(costs) else number - 1
                    while place > 0 and total < costs[place - 1]:
                        costs[place], found[place] = costs[place - 1], found[place - 1]
                        place -= 1
                    costs[place] = total
                    found[place, 0], found[place, 1] = a, b
                    found[place, 2], found[place, 3] = c, d
                    number = min(number + 1, len(costs))
                    if number == len(costs):
                        worst = costs[number - 1]
    return number


@kernel
def least_of_four(
    wanted: float, width: float, rows: FloatArray, before: float, best: float
) -> float:
    """Return the least cost of all; what with ``before`` reaches ``best`` may be skipped.

    Where all are skipped it is ``BARRED``.
    """
    states, found = rows.shape[2], BARRED
    least = rows[FOUR - 2, COST].min() + rows[FOUR - 1, COST].min()
    for a in range(states):
        for b in range(states):
            bound = rows[0, COST, a] + rows[1, COST, b] + least
            if bound >= found or before + bound >= best:
                continue
            for c in range(states):
                for d in range(states):
                    found = min(found, _cost_of(wanted, width, rows, a, b, c, d))
    return found
