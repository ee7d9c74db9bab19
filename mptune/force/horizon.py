"""The cheapest combination of both sides' states, looking one or two sampling periods ahead.

The cost of a combination is Eq. 7's, with Huber's count of the force error and a common-mode term
where asked for::

    J = ρ(F_ref − F̂) + W_cm |(p̂_A + p̂_B)/2 − p_mid| + cost of A's state + cost of B's state
    ρ(e) = e²/(2 f_0) below f_0, else |e| − f_0/2

Two periods ahead, the n combinations cheapest by J_1 are carried on by one more period each and
the least J_1 + min J_2 wins; velocity, supplies, converters and F_ref are held meanwhile. That is
exact for these n: what is skipped is skipped by a bound. As sums round monotonically, neither

    min J_2 ≥ least cost of A's states + least cost of B's       nor
    J_2 ≥ cost of A's state + least cost of B's

is ever broken by rounding. J_1 alone is no bound, since the converter term may be negative.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import FloatArray, IntArray, kernel
from mptune.force.dynamic import look_ahead
from mptune.force.estimator import SIDE_A, SIDE_B
from mptune.force.ports import BARRED, COMMON, COST, FORCE, PRESSURE, ROW, ports_of
from mptune.force.steady import settle

if TYPE_CHECKING:
    from mptune.force.ports import Ports
    from mptune.force.search_space import SearchSpace
    from mptune.params.packed import ForceSettings

_SIDES = 2


@kernel
def counted(error: float, width: float) -> float:
    """Return Huber's count of a force error [N]; linear throughout where the width is 0."""
    size = abs(error)
    if size < width:
        return size * size * (0.5 / width)
    return size - 0.5 * width


@kernel
def cheapest_pairs(
    wanted: float,
    width: float,
    row_a: FloatArray,
    row_b: FloatArray,
    least_b: float,
    costs: FloatArray,
    pairs: IntArray,
) -> int:
    """Fill the costs ``(n,)`` and numbers S a + b of the cheapest pairs, cheapest first.

    Of several equal ones the first comes first. Returned is how many there are.
    """
    found, worst = 0, BARRED  # of a full list, its dearest
    states = row_a.shape[1]
    for a in range(states):
        if row_a[COST, a] + least_b >= worst:
            continue
        for b in range(states):
            error = wanted - (row_a[FORCE, a] - row_b[FORCE, b])
            total = counted(error, width) + abs(row_a[COMMON, a] + row_b[COMMON, b])
            total = total + row_a[COST, a] + row_b[COST, b]  # Eq. 7
            if not total < worst:
                continue
            place = found if found < len(costs) else found - 1
            while place > 0 and total < costs[place - 1]:
                costs[place], pairs[place] = costs[place - 1], pairs[place - 1]
                place -= 1
            costs[place], pairs[place] = total, states * a + b
            found = min(found + 1, len(costs))
            if found == len(costs):
                worst = costs[found - 1]
    return found


@kernel
def least_pair(
    wanted: float,
    width: float,
    row_a: FloatArray,
    row_b: FloatArray,
    least_b: float,
    before: float,
    best: float,
    scratch: FloatArray,
) -> float:
    """Return the least cost of all pairs; pairs that with ``before`` reach ``best`` may be skipped.

    Where all are skipped it is ``BARRED``. ``scratch`` is ``(S,)``: the least of each of B's
    states, so that all of them are looked at in a few instructions.
    """
    force_b, cost_b, common_b = row_b[FORCE], row_b[COST], row_b[COMMON]
    states = len(cost_b)
    slope, half = (0.5 / width if width > 0 else 0.0), 0.5 * width
    for b in range(states):
        scratch[b] = BARRED
    for a in range(states):
        force, cost, common = row_a[FORCE, a], row_a[COST, a], row_a[COMMON, a]
        if before + (cost + least_b) >= best:
            continue
        for b in range(states):
            size = abs(wanted - (force - force_b[b]))
            square, line = size * size * slope, size - half
            total = (square if size < width else line) + abs(common + common_b[b])
            total = total + cost + cost_b[b]  # Eq. 7
            scratch[b] = total if total < scratch[b] else scratch[b]
    least = BARRED
    for b in range(states):
        least = min(least, scratch[b])
    return least


@kernel
def row_of(
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
    """Fill a row by the model that is asked for; return its least cost [N]."""
    if settings.steady_state > 0:
        return settle(side, pressure, position, velocity, present, ports, space, settings, row)
    return look_ahead(side, pressure, position, velocity, present, ports, space, settings, row)


@kernel
def best_ahead(
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
    """Return the states of A and B; parameters as ``mptune.force.select.decide`` has them."""
    ports, states = ports_of(supplies, converters, space), len(space.first)
    steps = int(settings.candidates)
    number = max(steps, 1)
    # Rows of both sides now, then one for each state that is met in the second period.
    rows = np.empty((_SIDES * (1 + min(number, states)), ROW, states))
    least = np.empty(len(rows))
    for side in range(_SIDES):
        pressure = pressure_a if side == SIDE_A else pressure_b
        present = present_a if side == SIDE_A else present_b
        least[side] = row_of(
            side, pressure, position, velocity, present, ports, space, settings, rows[side]
        )
    costs, pairs = np.empty(number), np.zeros(number, np.int64)
    width = settings.error_width
    found = cheapest_pairs(wanted, width, rows[SIDE_A], rows[SIDE_B], least[SIDE_B], costs, pairs)
    if steps == 0:
        return pairs[0] // states, pairs[0] % states
    position += velocity * settings.sampling_period
    where = np.zeros((_SIDES, states), np.int64)  # 0 where not met: row 0 is none of these
    met, best, chosen = _SIDES, BARRED, pairs[0]
    for k in range(found):
        for side in range(_SIDES):
            state = pairs[k] // states if side == SIDE_A else pairs[k] % states
            if where[side, state] == 0:
                pressure = rows[side, PRESSURE, state]
                least[met] = row_of(
                    side, pressure, position, velocity, state, ports, space, settings, rows[met]
                )
                where[side, state], met = met, met + 1
        then_a = where[SIDE_A, pairs[k] // states]
        then_b = where[SIDE_B, pairs[k] % states]
        if costs[k] + (least[then_a] + least[then_b]) >= best:
            continue
        later = least_pair(
            wanted, width, rows[then_a], rows[then_b], least[then_b], costs[k], best,
            ports.scratch[0],
        )  # fmt: skip
        if costs[k] + later < best:
            best, chosen = costs[k] + later, pairs[k]
    return chosen // states, chosen % states
