"""The decision for four chambers against a plain law over all combinations."""

from itertools import product

import numpy as np
import pytest
from deciding import side_of

from mptune.arrays import frozen
from mptune.force.chambers import decide_of_chambers
from mptune.force.cost import line_pressures
from mptune.force.search_space import space_of
from mptune.params.pack import pack_chambers
from mptune.params.packed import AREA, MADE_BY

pytestmark = pytest.mark.compiled

NOW = 'controller.delay_prediction="0 ms"'  # the plain law begins where the state is
DYNAMIC = ('controller.force_model="dynamic"', 'controller.weight_compression="0 N/J"')
MODELS = {
    "steady state": (NOW,),
    "paper": (NOW, *DYNAMIC),
    "levers": (
        NOW,
        *DYNAMIC,
        'controller.error="huber"',
        'controller.loss="path"',
        'controller.weight_common_mode="300 N/MPa"',
    ),
    "fixed penalty": (NOW, *DYNAMIC, 'controller.weight_pressure="0 N/Pa"'),
}


def states(count, seed, space, travel=0.075):
    random, converters = np.random.default_rng(seed), int(space.lines[MADE_BY].max()) + 1
    for _ in range(count):
        yield {
            "wanted": random.uniform(-2e4, 4e4),
            "p": random.uniform(0.5e6, 12.5e6, 4),
            "x": random.uniform(0, 0.3),
            "v": random.uniform(-0.12, 0.12),
            "supplies": line_pressures(1e6, random.uniform(11e6, 13e6), space),
            "converters": random.uniform(-travel, travel, converters),
            "present": random.integers(0, len(space.first), 4),
        }


def decided(case, space, more):
    choice = case["present"].copy()
    decide_of_chambers(
        case["wanted"], case["p"], case["x"], case["v"], case["supplies"], case["converters"],
        choice, space, more,
    )  # fmt: skip
    return tuple(int(one) for one in choice)


def plain_sides(case, space, more):
    """Pressures, signed forces and costs of every chamber's states by the plain law."""
    sides = []
    for i, settings in enumerate(more.settings):
        side = int(more.table[AREA, i] < 0)
        now = int(case["present"][i])
        after, force, cost = side_of(side, case["p"][i], case["x"], now, case, space, settings)
        sides.append((after, -force if side else force, cost))
    return sides


def plain_costs(case, space, more):
    """Costs of all combinations by the plain law of one chamber, as a mapping."""
    sides, s = plain_sides(case, space, more), more.settings[0]
    middle, found = (case["supplies"][0] + case["supplies"][-1]) / 2, {}
    for states_ in product(range(len(space.first)), repeat=4):
        rows = [[column[state] for column in side]
                for side, state in zip(sides, states_, strict=True)]  # fmt: skip
        after, force, cost = (sum(column) for column in zip(*rows, strict=True))
        error, width = abs(case["wanted"] - force), s.error_width
        small = error < width
        total = error**2 / (2 * width) if small else error - width / 2
        found[states_] = total + s.weight_common_mode * abs(after / 4 - middle) + cost
    return found


def plain_costs_ahead(case, space, more):
    """The same over two periods, of the cheapest combinations of the first."""
    costs = plain_costs(case, space, more)
    pressures = [side[0] for side in plain_sides(case, space, more)]
    s, found = more.settings[0], {}
    for chosen in sorted(costs, key=costs.get)[: int(s.candidates)]:
        then = {
            **case,
            "p": [one[state] for one, state in zip(pressures, chosen, strict=True)],
            "x": case["x"] + case["v"] * s.sampling_period,
            "present": chosen,
        }
        found[chosen] = costs[chosen] + min(plain_costs(then, space, more).values())
    return found


@pytest.mark.parametrize("name", MODELS)
def test_decisions_are_the_cheapest_of_all_combinations(load_shape, name):
    study = load_shape("four-chamber", *MODELS[name])
    space, more = space_of(study), pack_chambers(study)
    met = set()
    for case in states(40, 3, space):
        costs, chosen = plain_costs(case, space, more), decided(case, space, more)
        assert len(costs) == 81
        assert costs[chosen] == pytest.approx(min(costs.values()), rel=1e-9, abs=1e-5)
        met.add(chosen)
    assert len(met) > 10


def test_decisions_with_converters_are_the_cheapest_of_all_combinations(load_shape):
    """Every chamber's flow out of a converter's port counts: 4096 combinations of eight states."""
    study = load_shape("four-converters")
    space, more = space_of(study), pack_chambers(study)
    still = more._replace(settings=tuple(one._replace(weight_converter=0.0)
                                         for one in more.settings))  # fmt: skip
    differs = 0
    for case in states(8, 11, space):
        costs, chosen = plain_costs(case, space, more), decided(case, space, more)
        assert len(costs) == 4096
        assert costs[chosen] == pytest.approx(min(costs.values()), rel=1e-9, abs=1e-5)
        differs += decided(case, space, still) != chosen
    assert differs > 3


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("candidates", [2, 6])
def test_two_periods_ahead_the_candidates_cheapest_with_what_follows_is_taken(
    load_shape, name, candidates
):
    two = ("controller.horizon=2", f"controller.candidates={candidates}")
    study = load_shape("four-chamber", *MODELS[name], *two)
    space, more = space_of(study), pack_chambers(study)
    one = more._replace(settings=tuple(s._replace(candidates=0.0) for s in more.settings))
    differs = 0
    for case in states(15, 4, space):
        costs, chosen = plain_costs_ahead(case, space, more), decided(case, space, more)
        assert costs[chosen] == pytest.approx(min(costs.values()), rel=1e-9, abs=1e-5)
        differs += chosen != decided(case, space, one)
    assert differs > 0


def test_as_many_candidates_as_combinations_and_one_of_them_agree_at_the_ends(load_shape):
    """One candidate is the first period's cheapest, whatever follows."""
    study = load_shape("four-chamber", *MODELS["levers"], "controller.horizon=2")
    space, more = space_of(study), pack_chambers(study)

    def with_candidates(number):
        settings = tuple(s._replace(candidates=float(number)) for s in more.settings)
        return more._replace(settings=settings)

    for case in states(40, 6, space):
        single = decided(case, space, with_candidates(1))
        assert single == decided(case, space, with_candidates(0))
        every = [decided(case, space, with_candidates(n)) for n in (81, 100)]
        assert every[0] == every[1]


def test_a_mirrored_machine_decides_in_mirror_image(load_shape):
    """Equal areas in pairs; sides, velocity and force change places."""
    study = load_shape("four-chamber", *MODELS["paper"])
    space, more = space_of(study), pack_chambers(study)
    wide, narrow, valves = 20e-4, 9e-4, 4e-7
    table = more.table.copy()
    table[AREA] = wide, -wide, narrow, -narrow
    settings = tuple(
        one._replace(area_a=max(area, 0.0), area_b=max(-area, 0.0), flow_coefficient=valves)
        for one, area in zip(more.settings, table[AREA], strict=True)
    )
    more, swapped = more._replace(table=frozen(table), settings=settings), [1, 0, 3, 2]
    for case in states(60, 9, space):
        mirror = {
            **case,
            "wanted": -case["wanted"],
            "p": case["p"][swapped],
            "x": settings[0].stroke - case["x"],
            "v": -case["v"],
            "present": case["present"][swapped],
        }
        chosen = decided(case, space, more)
        assert decided(mirror, space, more) == tuple(chosen[i] for i in swapped)


def test_pressures_are_carried_through_the_valve_delay_first(load_shape):
    study = load_shape("four-chamber", *DYNAMIC, 'controller.delay_prediction="5 ms"')
    space, more = space_of(study), pack_chambers(study)
    still = tuple(one._replace(delay_prediction=0.0) for one in more.settings)
    differs = sum(
        decided(case, space, more) != decided(case, space, more._replace(settings=still))
        for case in states(40, 5, space)
    )
    assert differs > 5
