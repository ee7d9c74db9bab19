"""The valve states of one side as their rule makes them (§2.3.1): which valves are open in each."""

from __future__ import annotations

from enum import StrEnum
from itertools import islice
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

ValveSet = dict[int, tuple[int, ...]]
"""The open valves of each line that is connected."""


class StateKind(StrEnum):
    """Valve states of one side beside the closed one, in the order of their numbers (Eq. 6)."""

    ALL = "all"  # every valve of one line
    SINGLE = "single"  # the first valve of one line
    SUBSETS = "subsets"  # every choice among one line's valves
    CROSSFLOW = "crossflow"  # neighbouring lines: first and first, all and first, first and all


class EdgeRule(NamedTuple):
    """The valves of every line, and which states of them there are; the same for both chambers."""

    sizes: tuple[tuple[float, ...], ...]  # (L,) of each line's parallel valves, in K_v
    states: tuple[StateKind, ...]

    @property
    def valves(self) -> int:
        """Valves of one side."""
        return sum(map(len, self.sizes))


def valve_states(rule: EdgeRule) -> list[ValveSet]:
    """Return the states of one side, the closed one first, then kind by kind."""
    return [state for _, state in _every_state(rule)]


def states_by_kind(rule: EdgeRule) -> list[list[ValveSet]]:
    """Return the closed state, then those of each kind; what an earlier kind has is left out."""
    found: list[list[ValveSet]] = [[] for _ in range(1 + len(rule.states))]
    for kind, state in _every_state(rule):
        found[kind].append(state)
    return found


def number_of_states(rule: EdgeRule, most: int) -> int:
    """Return how many states one side has, at most one more than asked about."""
    return sum(1 for _ in islice(_every_state(rule), most + 1))


def _every_state(rule: EdgeRule) -> Iterator[tuple[int, ValveSet]]:
    """Yield each state once, with the number of its kind: 0 of the closed one, then from 1."""
    yield 0, {}
    met: set[tuple[tuple[int, tuple[int, ...]], ...]] = {()}
    for number, kind in enumerate(rule.states, 1):
        for state in _states_of(kind, rule.sizes):
            key = tuple(sorted(state.items()))
            if key not in met:
                met.add(key)
                yield number, state


def _states_of(kind: StateKind, sizes: Sequence[Sequence[float]]) -> Iterator[ValveSet]:
    every: list[tuple[int, ...]]
    every = [tuple(range(len(parallel))) for parallel in sizes]
    pairs = [(low, low + 1) for low in range(len(sizes) - 1)]
    if kind is StateKind.ALL:
        for line, valves in enumerate(every):
            yield {line: valves}
    elif kind is StateKind.SINGLE:
        for line in range(len(sizes)):
            yield {line: (0,)}
    elif kind is StateKind.SUBSETS:
        for line, valves in enumerate(every):
            for number in range(1, 2 ** len(valves)):
                yield {line: tuple(k for k in valves if number >> k & 1)}
    else:
        for low, high in pairs:
            yield {low: (0,), high: (0,)}
        for low, high in pairs:
            yield {low: every[low], high: (0,)}
            yield {low: (0,), high: every[high]}
