"""The decision beyond the paper: fast against plain, one period ahead and two."""

import numpy as np
import pytest
from deciding import chosen, costs_ahead, first_costs, states

from mptune.force.cost import side_costs
from mptune.force.dynamic import look_ahead
from mptune.force.horizon import cheapest_pairs, counted, least_pair, row_of
from mptune.force.ports import COMMON, COST, FORCE, PRESSURE, ROW, ports_of
from mptune.force.search_space import search_space
from mptune.force.select import decide
from mptune.params.pack import pack_force

STATES = 28  # of one side of the paper's machine

HUBER = 'controller.error="huber"'
PATH = 'controller.loss="path"'
TWO = "controller.horizon=2"
COMMON_MODE = 'controller.weight_common_mode="300 N/MPa"'
STEADY = (
    'controller.force_model="steady-state"',
    'controller.weight_switching="400 N"',
    'controller.weight_loss="200 N/J"',
    'controller.weight_compression="60 N/J"',
)
OPTIONS = {
    "huber": (HUBER,),
    "path": (PATH,),
    "common mode": (COMMON_MODE,),
    "all": (HUBER, PATH, COMMON_MODE, 'controller.converter_flow="mean"'),
    "steady": STEADY,
    "steady and huber": (*STEADY, HUBER, COMMON_MODE),
}
COMPILED = hasattr(decide, "py_func")
ALL = STATES * STATES


def plain(case, space, settings):
    """The decision without bounds or lists: numpy over all pairs, on the same rows."""
    ports = ports_of(case["supplies"], case["converters"], space)
    x, v, wanted, width = case["x"], case["v"], case["wanted"], settings.error_width

    def row(side, pressure, position, present):
        found = np.empty((ROW, STATES))
        row_of(side, pressure, position, v, present, ports, space, settings, found)
        return found

    def costs(a, b):
        error = np.abs(wanted - (a[FORCE][:, None] - b[FORCE]))
        slope = 0.5 / width if width > 0 else 0.0
        count = np.where(error < width, error * error * slope, error - 0.5 * width)
        return count + np.abs(a[COMMON][:, None] + b[COMMON]) + a[COST][:, None] + b[COST]

    a, b = (row(side, case["p"][side], x, case["present"][side]) for side in range(2))
    first = costs(a, b).ravel()
    if not settings.candidates:
        return divmod(int(np.argmin(first)), STATES)
    candidates = np.argsort(first, kind="stable")[: int(settings.candidates)]
    x += v * settings.sampling_period
    then_a = {i: row(0, a[PRESSURE, i], x, i) for i in set((candidates // STATES).tolist())}
    then_b = {j: row(1, b[PRESSURE, j], x, j) for j in set((candidates % STATES).tolist())}
    pairs = [divmod(int(number), STATES) for number in candidates]
    totals = [first[STATES * i + j] + costs(then_a[i], then_b[j]).min() for i, j in pairs]
    return pairs[int(np.argmin(totals))]


@pytest.mark.parametrize(
    ("options", "count"),
    [
        ((TWO, HUBER, PATH), 10_000),
        ((TWO,), 1_000),
        ((TWO, PATH, COMMON_MODE, "controller.candidates=17"), 1_000),
        ((TWO, HUBER, f"controller.candidates={ALL}"), 100),
        ((TWO, *STEADY), 1_000),
        ((HUBER,), 1_000),
    ],
    ids=["the tuned one", "two", "17 candidates", "all candidates", "steady", "one"],
)
def test_the_fast_decision_is_the_plain_one(load_boom, options, count):
    settings, space = pack_force(load_boom(*options)), search_space()
    wrong = 0
    for case in states(count if COMPILED else 5, 31):
        wrong += chosen(case, space, settings) != plain(case, space, settings)
    assert wrong == 0


@pytest.mark.parametrize("name", OPTIONS)
def test_one_period_ahead_it_is_the_cheapest_of_all_combinations(load_boom, name):
    settings, space = pack_force(load_boom(*OPTIONS[name])), search_space()
    picked, count = set(), 20 if COMPILED else 5
    for case in states(count, 12):
        costs, _, _ = first_costs(case, space, settings)
        found = chosen(case, space, settings)
        picked.add(found)
        assert costs[found] <= costs.min() + 1e-6 + 1e-9 * abs(costs.min())
    assert len(picked) > count / 4


@pytest.mark.parametrize("name", OPTIONS)
def test_two_periods_ahead_it_is_the_cheapest_of_its_candidates(load_boom, name):
    """Candidates that tie at the end of the list may be other ones here: they cost the same."""
    settings, space = pack_force(load_boom(*OPTIONS[name], TWO)), search_space()
    for case in states(6 if COMPILED else 2, 13):
        costs = costs_ahead(case, space, settings)
        found, least = chosen(case, space, settings), min(costs.values())
        assert costs[found] <= least + 1e-6 + 1e-9 * abs(least)


def test_two_periods_ahead_decide_otherwise_than_one(load_boom):
    space, one = search_space(), pack_force(load_boom(HUBER))
    for options in ((TWO, HUBER), (TWO, HUBER, "controller.candidates=20")):
        two = pack_force(load_boom(*options))
        cases = list(states(100 if COMPILED else 5, 5))
        differ = sum(chosen(case, space, one) != chosen(case, space, two) for case in cases)
        print(f"{options}: {differ} of {len(cases)} decisions differ")
        assert differ > 0.1 * len(cases)


def test_the_cost_of_the_first_period_alone_is_no_bound(load_boom):
    """With converters far out a later period may give back: winners cost less than J_1 says."""
    settings, space = pack_force(load_boom(TWO)), search_space()
    gained = 0
    for case in states(6, 14):
        case["converters"] = np.array([0.07, -0.07, 0.07, -0.07])
        costs, first = costs_ahead(case, space, settings), first_costs(case, space, settings)[0]
        gained += any(total < first[pair] for pair, total in costs.items())
    assert gained > 0


@pytest.mark.parametrize("side", [0, 1])
def test_with_nothing_switched_on_a_row_is_the_paper_s_own(boom, side):
    settings, space = pack_force(boom), search_space()
    force, cost, row = np.empty(28), np.empty(28), np.empty((ROW, STATES))
    for case in states(200 if COMPILED else 3, 15):
        args = case["p"][side], case["x"], case["v"]
        ports = ports_of(case["supplies"], case["converters"], space)
        present = case["present"][side]
        least = look_ahead(side, *args, present, ports, space, settings, row)
        side_costs(
            side, *args, case["supplies"], case["converters"], present, space, settings, force, cost
        )
        np.testing.assert_allclose(row[FORCE], force, rtol=1e-12)
        np.testing.assert_allclose(row[COST], cost, rtol=1e-9, atol=1e-6)
        assert least == row[COST].min()
        assert not row[COMMON].any()


def test_of_several_equal_pairs_the_first_comes_first():
    """Costs of small whole numbers tie all the time: their sums are exact."""
    random = np.random.default_rng(6)
    for _ in range(200 if COMPILED else 5):
        a, b = random.integers(0, 4, (2, ROW, STATES)).astype(float)
        b[COMMON] *= -1
        error = np.abs(1.0 - (a[FORCE][:, None] - b[FORCE]))
        counts = np.where(error < 2, error**2 / 4, error - 1)
        costs = counts + np.abs(a[COMMON][:, None] + b[COMMON]) + a[COST][:, None] + b[COST]
        order = np.argsort(costs.ravel(), kind="stable")[:9]
        found, pairs = np.empty(9), np.zeros(9, np.int64)
        assert cheapest_pairs(1.0, 2.0, a, b, b[COST].min(), found, pairs) == 9
        assert pairs.tolist() == order.tolist()
        assert found.tolist() == costs.ravel()[order].tolist()
        scratch = np.empty(STATES)
        least = least_pair(1.0, 2.0, a, b, b[COST].min(), 0.0, np.inf, scratch)
        assert least == costs.min()
        assert least_pair(1.0, 2.0, a, b, b[COST].min(), 5.0, 5.0 + least, scratch) >= least


@pytest.mark.parametrize(("error", "expected"), [(0, 0), (1e3, 250), (-2e3, 1e3), (-5e3, 4e3)])
def test_huber_counts_small_errors_by_their_square(error, expected):
    assert counted(error, 2e3) == pytest.approx(expected)
    assert counted(error, 0.0) == abs(error)


@pytest.mark.compiled
@pytest.mark.parametrize("options", [(TWO, HUBER, PATH, COMMON_MODE), (TWO, *STEADY)])
def test_compiled_decisions_equal_interpreted_ones(load_boom, options):
    settings, space = pack_force(load_boom(*options)), search_space()
    for case in states(40, 24):
        assert chosen(case, space, settings) == chosen(case, space, settings, decide.py_func)
