"""The decision's laws in plain Python, and random states to decide in."""

import math
from itertools import pairwise

import numpy as np

from mptune.force.cost import line_pressures
from mptune.force.search_space import search_space
from mptune.force.select import decide
from mptune.params.packed import MADE_BY


def root(difference, transition):
    size = abs(difference)
    if size >= transition:
        return math.copysign(math.sqrt(size), difference)
    return difference * (3 - size / transition) / (2 * math.sqrt(transition))


def stiffness(side, x, s):
    if side == 0:
        volume, hose = s.area_a * x + s.dead_a, s.hose_a
    else:
        volume, hose = s.area_b * (s.stroke - x) + s.dead_b, s.hose_b
    return 1 / (1 / s.oil + hose / volume / s.hose) / volume


def heun_path(side, p, x, v, supplies, counts, span, s):
    """Eq. 5: four Heun steps over ``span``, with Eq. 1's first two lines; all five pressures."""
    taken = s.area_a * v if side == 0 else -s.area_b * v

    def slope(p, x):
        flow = sum(
            n * root(q - p, s.transition_pressure) for q, n in zip(supplies, counts, strict=True)
        )
        return stiffness(side, x, s) * (s.flow_coefficient * flow - taken)

    h, path = span / 4, [p]
    for _ in range(4):
        k1 = slope(p, x)
        k2 = slope(p + h * k1, x + h * v)
        p += h / 2 * (k1 + k2)
        x += h * v
        path.append(p)
    return path


def heun(*args):
    """The pressure at the end."""
    return heun_path(*args)[-1]


def counts_of(space, state):
    """Open valves towards each line, in units of the flow coefficient."""
    line, size = space.edge
    return np.bincount(line.astype(int), size * space.valves[state], space.lines.shape[1])


def flows(p, counts, supplies, s):
    """Flow into the chamber from each supply at a pressure [m³/s]."""
    return [
        s.flow_coefficient * n * root(q - p, s.transition_pressure)
        for q, n in zip(supplies, counts, strict=True)
    ]


def throttled(p, counts, supplies, s):
    """Power lost in the valves at a pressure [W]."""
    return sum(f * (q - p) for f, q in zip(flows(p, counts, supplies, s), supplies, strict=True))


def settled(side, v, supplies, counts, s):
    """The pressure at which the valves pass what the piston takes, by halving [Pa]."""
    taken = s.area_a * v if side == 0 else -s.area_b * v
    low, high = -1e8, 1e8
    for _ in range(50):
        middle = (low + high) / 2
        if sum(flows(middle, counts, supplies, s)) > taken:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def side_of(side, p, x, present, case, space, s):
    """Pressures, forces and costs of one side's states, every option of the decision counted."""
    v, supplies, period = case["v"], case["supplies"], s.sampling_period
    rows = []
    for state in range(len(space.first)):
        counts = counts_of(space, state)
        extra = 0.0
        if s.steady_state:
            closed = not counts.any()
            after = p if closed else settled(side, v, supplies, counts, s)
            energy = period * throttled(after, counts, supplies, s)
            ends = (after, after)
            extra = s.weight_compression * (after - p) ** 2 / (2 * stiffness(side, x, s))
            extra += 1e30 * (closed and abs(v) > s.rest_velocity)
        else:
            path = heun_path(side, p, x, v, supplies, counts, period, s)
            ends, after = (path[0], path[-1]), path[-1]
            powers = [throttled(q, counts, supplies, s) for q in path]
            energy = period / 2 * (powers[0] + powers[-1])
            if s.path_loss:
                energy = sum(period / 8 * (one + two) for one, two in pairwise(powers))
        then, now = (flows(q, counts, supplies, s) for q in (ends[1], ends[0]))
        share, conversion = s.predicted_share, 0.0
        for line, converter in enumerate(space.lines[MADE_BY].astype(int)):
            if converter >= 0:
                into = -(share * then[line] + (1 - share) * now[line])
                conversion += into * case["converters"][converter] ** 3
        switches = np.abs(space.valves[state] - space.valves[present]).sum()
        cost = s.weight_switching * switches + s.weight_loss * energy + extra
        cost += s.weight_converter * conversion
        beyond = max(s.pressure_min - after, after - s.pressure_max, 0)
        cost += s.weight_pressure * beyond if s.weight_pressure else 1e6 * (beyond > 0)
        rows.append((after, (s.area_a, s.area_b)[side] * after, cost))
    return np.array(rows).T


def pair_costs(a, b, case, s):
    """Costs of all combinations of two sides, ``(S, S)``."""
    error = np.abs(case["wanted"] - (a[1][:, None] - b[1]))
    width = s.error_width
    small = error < width
    counted = np.where(small, error**2 / (2 * width if width else 1), error - width / 2)
    middle = (case["supplies"][0] + case["supplies"][-1]) / 2
    common = np.abs((a[0][:, None] + b[0]) / 2 - middle)
    return counted + s.weight_common_mode * common + a[2][:, None] + b[2]


def first_costs(case, space, s):
    """Costs of all combinations over one period, and both sides' states."""
    p, x, present = case["p"], case["x"], case["present"]
    a, b = (side_of(side, p[side], x, present[side], case, space, s) for side in range(2))
    return pair_costs(a, b, case, s), a, b


def costs_ahead(case, space, s):
    """Costs over two periods of the candidates, as a mapping, by the plain law."""
    costs, a, b = first_costs(case, space, s)
    x = case["x"] + case["v"] * s.sampling_period
    found = {}
    for number in np.argsort(costs.ravel(), kind="stable")[: int(s.candidates)]:
        i, j = divmod(int(number), len(space.first))
        then_a = side_of(0, a[0][i], x, i, case, space, s)
        then_b = side_of(1, b[0][j], x, j, case, space, s)
        found[i, j] = costs[i, j] + pair_costs(then_a, then_b, case, s).min()
    return found


def states(count, seed, space=None, highest=(11e6, 16e6), low=2e6):
    """Random states of a machine, the paper's by default; its highest line varies."""
    space = space or search_space()
    converters = int(space.lines[MADE_BY].max()) + 1
    random = np.random.default_rng(seed)
    for _ in range(count):
        high = random.uniform(*highest)
        yield {
            "wanted": random.uniform(-5e4, 7e4),
            "p": random.uniform(0.15 * low, highest[1] + 0.5e6, 2),
            "x": random.uniform(0, 0.3),
            "v": random.uniform(-0.12, 0.12),
            "supplies": line_pressures(low, high, space),
            "converters": random.uniform(-0.075, 0.075, converters),
            "present": tuple(int(i) for i in random.integers(0, len(space.first), 2)),
        }


def chosen(case, space, s, function=decide):
    return function(
        case["wanted"], *case["p"], case["x"], case["v"], case["supplies"], case["converters"],
        *case["present"], space, s,
    )  # fmt: skip
