"""The 28 valve states of one side, generated from their rule (§2.3.1)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mptune.arrays import FloatArray, IntArray, frozen

_SUPPLIES = 6


class SearchSpace(NamedTuple):
    """One side's states; both sides have the same."""

    valves: IntArray  # (28, 12) 1 where a valve is open: two in parallel per supply
    first: IntArray  # (28,) a supply that is connected
    first_count: FloatArray  # (28,) its open valves
    second: IntArray  # (28,) the other supply in crossflow
    second_count: FloatArray  # (28,) its open valves; 0 without crossflow
    switches: FloatArray  # (28, 28) valves that differ between two states


def search_space() -> SearchSpace:
    """Return the search space SS_A = SS_B.

    State 0 shuts all valves; 1 to 6 open both valves of one supply, 7 to 12 one valve of one,
    13 to 17 one valve each of two neighbouring supplies, 18 to 27 two of one and one of the other.
    """
    both = [{supply: 2} for supply in range(_SUPPLIES)]
    single = [{supply: 1} for supply in range(_SUPPLIES)]
    pairs = [(low, low + 1) for low in range(_SUPPLIES - 1)]
    even = [{low: 1, high: 1} for low, high in pairs]
    uneven = [counts for low, high in pairs for counts in ({low: 2, high: 1}, {low: 1, high: 2})]
    states: list[dict[int, int]] = [{}, *both, *single, *even, *uneven]  # Eq. 6
    valves = np.zeros((len(states), 2 * _SUPPLIES), np.int64)
    ports = np.zeros((len(states), 2), np.int64)
    counts = np.zeros((len(states), 2))
    for row, state in enumerate(states):
        for place, (supply, count) in enumerate(state.items()):
            valves[row, 2 * supply : 2 * supply + count] = 1
            ports[row, place], counts[row, place] = supply, count
    switches = np.abs(valves[:, None] - valves[None]).sum(axis=2).astype(np.float64)
    first, second = (np.ascontiguousarray(column) for column in ports.T)
    first_count, second_count = (np.ascontiguousarray(column) for column in counts.T)
    return SearchSpace(
        frozen(valves),
        frozen(first),
        frozen(first_count),
        frozen(second),
        frozen(second_count),
        frozen(switches),
    )
