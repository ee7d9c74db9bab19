"""Eq. 6: the search space of one side."""

import numpy as np
import pytest

from mptune.force.search_space import search_space


@pytest.fixture(scope="module")
def space():
    return search_space()


@pytest.fixture(scope="module")
def per_supply(space):
    """Open valves towards each of the six supplies, ``(28, 6)``."""
    return space.valves.reshape(28, 6, 2).sum(axis=2)


def test_the_groups_are_1_6_6_5_10_in_the_paper_s_order(per_supply):
    kinds = [tuple(sorted(row[row > 0])) for row in per_supply]
    assert kinds == [(), *[(2,)] * 6, *[(1,)] * 6, *[(1, 1)] * 5, *[(1, 2)] * 10]


def test_states_of_one_supply_run_from_the_lowest_to_the_highest(per_supply):
    assert [int(np.argmax(per_supply[state])) for state in range(1, 13)] == [*range(6), *range(6)]


def test_crossflow_joins_neighbours_only_and_each_pair_three_ways(per_supply):
    counts = {}
    for row in per_supply[13:]:
        low, high = np.flatnonzero(row)
        assert high == low + 1
        counts.setdefault(int(low), set()).add((int(row[low]), int(row[high])))
    assert counts == {low: {(1, 1), (2, 1), (1, 2)} for low in range(5)}


def test_at_most_three_valves_are_open_and_no_state_comes_twice(space):
    assert set(np.unique(space.valves)) == {0, 1}
    assert space.valves.sum(axis=1).max() == 3
    assert len({tuple(row) for row in space.valves}) == 28


def test_ports_and_counts_say_the_same_as_the_valves(space, per_supply):
    rebuilt = np.zeros((28, 6))
    for state in range(28):
        rebuilt[state, space.first[state]] += space.first_count[state]
        rebuilt[state, space.second[state]] += space.second_count[state]
    np.testing.assert_array_equal(rebuilt, per_supply)


def test_switches_count_the_valves_that_differ(space):
    """From one valve to both is one switch, from one supply's both to another's is four."""
    for one in range(28):
        for other in range(28):
            differ = sum(
                a != b for a, b in zip(space.valves[one], space.valves[other], strict=True)
            )
            assert space.switches[one, other] == differ
    assert space.switches[7, 1] == 1
    assert space.switches[1, 2] == 4


def test_the_space_cannot_be_changed(space):
    with pytest.raises(ValueError, match="read-only"):
        space.valves[0, 0] = 1
