"""Eq. 7 and Eq. 8: the cost function, against all 28² combinations in plain Python."""

import numpy as np
import pytest
from deciding import chosen, heun, root, states

from mptune.force.controller import ForceController, Measured
from mptune.force.cost import side_costs, supply_pressures
from mptune.force.search_space import search_space
from mptune.force.select import cheapest, decide
from mptune.params.pack import pack_force


def side_terms(side, case, present, share, space, s):
    """The force of each of one side's 28 states and what it adds to Eq. 7."""
    terms = []
    p, x, v = case["p"][side], case["x"], case["v"]
    for state in range(28):
        counts = space.valves[state].reshape(6, 2).sum(axis=1)
        after = heun(side, p, x, v, case["supplies"], counts, s.sampling_period, s)
        loss = conversion = 0.0
        for i, count in enumerate(counts):
            drops = case["supplies"][i] - p, case["supplies"][i] - after
            flows = [s.flow_coefficient * count * root(d, s.transition_pressure) for d in drops]
            power = [flow * drop for flow, drop in zip(flows, drops, strict=True)]
            loss += s.sampling_period / 2 * sum(power)  # Eq. 8
            if 1 <= i <= 4:  # a converter fills while flow comes back through its port
                into = -((1 - share) * flows[0] + share * flows[1])
                conversion += into * case["converters"][i - 1] ** 3
        switches = np.abs(space.valves[state] - space.valves[present]).sum()
        cost = s.weight_switching * switches + s.weight_loss * loss
        cost += s.weight_converter * conversion
        cost += 1e6 * (not s.pressure_min <= after <= s.pressure_max)
        terms.append(((s.area_a, s.area_b)[side] * after, cost))
    return np.array(terms).T


def brute_force(case, share, space, s):
    """Return Eq. 7's costs of all combinations, ``(28, 28)``."""
    lag = s.delay_prediction
    if lag > 0:
        case = dict(case)
        counts = [space.valves[state].reshape(6, 2).sum(axis=1) for state in case["present"]]
        args = case["x"], case["v"], case["supplies"]
        case["p"] = [heun(i, case["p"][i], *args, counts[i], lag, s) for i in range(2)]
        case["x"] += case["v"] * lag
    (f_a, c_a), (f_b, c_b) = (
        side_terms(side, case, case["present"][side], share, space, s) for side in range(2)
    )
    return np.abs(case["wanted"] - f_a[:, None] + f_b) + c_a[:, None] + c_b


def test_selection_finds_the_least_of_784_for_ten_thousand_random_costs():
    random = np.random.default_rng(7)
    for _ in range(10_000 if hasattr(cheapest, "py_func") else 500):
        f_a, f_b = random.uniform(0, 8e4, 28), random.uniform(0, 6e4, 28)
        c_a, c_b = random.exponential(2e3, (2, 28))
        wanted = random.uniform(-6e4, 8e4)
        costs = np.abs(wanted - (f_a[:, None] - f_b)) + c_a[:, None] + c_b
        assert cheapest(wanted, f_a, c_a, f_b, c_b) == divmod(int(np.argmin(costs)), 28)


def test_of_several_equal_costs_the_first_wins():
    """Costs of small whole numbers tie all the time: their sums are exact."""
    random = np.random.default_rng(3)
    ties = 0
    for _ in range(300):
        f_a, c_a, f_b, c_b = random.integers(0, 4, (4, 28)).astype(float)
        costs = np.abs(1 - (f_a[:, None] - f_b)) + c_a[:, None] + c_b
        ties += (costs == costs.min()).sum() > 1
        assert cheapest(1.0, f_a, c_a, f_b, c_b) == divmod(int(np.argmin(costs)), 28)
    print(f"{ties} of 300 had ties")
    assert ties > 50


@pytest.mark.parametrize("flow", ["predicted", "present", "mean"])
@pytest.mark.parametrize("lag", ["0 ms", "6.5 ms"])
def test_decision_is_the_cheapest_of_all_combinations(load_boom, flow, lag):
    overrides = f"controller.converter_flow={flow}", f"controller.delay_prediction={lag}"
    settings, space = pack_force(load_boom(*overrides)), search_space()
    share = {"predicted": 1.0, "present": 0.0, "mean": 0.5}[flow]
    picked, count = set(), 100 if hasattr(decide, "py_func") else 10
    for case in states(count, 11):
        costs = brute_force(case, share, space, settings)
        found = chosen(case, space, settings)
        picked.add(found)
        # A cost a rounding error above the least is a tie, no mistake.
        assert costs[found] <= costs.min() + 1e-9 * max(costs.min(), 1.0)
    print(f"{flow}, {lag}: {len(picked)} different combinations in {count} states")
    assert len(picked) > count / 4


@pytest.mark.parametrize("side", [0, 1])
def test_each_side_s_costs_and_forces_are_those_of_the_equations(boom, side):
    settings, space = pack_force(boom), search_space()
    for case in states(20, 5):
        force, cost = np.empty(28), np.empty(28)
        side_costs(
            side, case["p"][side], case["x"], case["v"], case["supplies"], case["converters"],
            case["present"][side], space, settings, force, cost,
        )  # fmt: skip
        expected = side_terms(side, case, case["present"][side], 1.0, space, settings)
        np.testing.assert_allclose(force, expected[0], rtol=1e-10)
        np.testing.assert_allclose(cost, expected[1], rtol=1e-8, atol=1e-6)


@pytest.mark.compiled  # interpreted, it would take minutes
def test_the_three_readings_of_q_conv_and_the_delay_prediction_decide_differently(load_boom):
    """Otherwise the tests above would not tell the options apart."""
    space = search_space()
    overrides = ["controller.converter_flow=present"], ["controller.converter_flow=mean"]
    others = [*overrides, ["controller.delay_prediction=6.5 ms"]]
    plain = [chosen(case, space, pack_force(load_boom())) for case in states(100, 2)]
    for changed in others:
        settings = pack_force(load_boom(*changed))
        found = [chosen(case, space, settings) for case in states(100, 2)]
        differ = sum(a != b for a, b in zip(plain, found, strict=True))
        print(f"{changed[0]}: {differ} of 100 decisions differ")
        assert differ > 0


@pytest.mark.parametrize("supply", [1, 2, 3, 4])
@pytest.mark.parametrize("place", [-0.05, 0.05])
def test_the_cost_favours_flow_that_moves_a_converter_back(boom, supply, place):
    """A full converter (positive) is cheaper to draw from than to fill, and the reverse."""
    settings, space = pack_force(boom), search_space()
    supplies, converters = supply_pressures(2e6, 14e6), np.zeros(4)
    converters[supply - 1] = place
    conversion = {}
    for name, pressure in (("drawn", supplies[supply] - 3e6), ("filled", supplies[supply] + 3e6)):
        costs = []
        for positions in (converters, np.zeros(4)):
            force, cost = np.empty(28), np.empty(28)
            side_costs(0, pressure, 0.15, 0.0, supplies, positions, 0, space, settings, force, cost)
            costs.append(cost[7 + supply])
        conversion[name] = costs[0] - costs[1]
    print(conversion)
    assert np.sign(place) * conversion["drawn"] < 0 < np.sign(place) * conversion["filled"]


@pytest.mark.compiled
def test_compiled_decisions_equal_interpreted_ones(boom):
    """The interpreted decision calls compiled parts; the parts are compared on their own too."""
    settings, space = pack_force(boom), search_space()
    for case in states(60, 23):
        assert chosen(case, space, settings) == chosen(case, space, settings, decide.py_func)
        results = []
        for function in (side_costs, side_costs.py_func):
            force, cost = np.empty(28), np.empty(28)
            function(
                0, case["p"][0], case["x"], case["v"], case["supplies"], case["converters"],
                case["present"][0], space, settings, force, cost,
            )  # fmt: skip
            results.append((force, cost))
        np.testing.assert_allclose(results[0], results[1], rtol=1e-13, atol=1e-9)


def test_the_controller_alone_decides_as_the_kernel_does(boom):
    """Stepped through a run of states, each with the choice before it as the present one."""
    controller, settings, space = ForceController(boom), pack_force(boom), search_space()
    assert controller.states == (0, 0)
    for case in states(50, 17):
        supplies = case["supplies"]
        measured = Measured(
            case["x"], case["v"], *case["p"], supplies[0], supplies[5], case["converters"]
        )
        expected = chosen(case | {"present": controller.states}, space, settings)
        valves = controller.step(case["wanted"], measured, case["x"] + 0.01, 0.05)
        assert controller.states == expected
        np.testing.assert_array_equal(valves[:12], space.valves[expected[0]])
        np.testing.assert_array_equal(valves[12:], space.valves[expected[1]])
