"""The valve states of one side, generated from their rule (§2.3.1)."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, IntArray, frozen
from mptune.params.line_table import paper_table
from mptune.params.lines import Edges, edge_rule
from mptune.params.pack import pack_lines
from mptune.params.valve_states import valve_states

if TYPE_CHECKING:
    from mptune.params.study import ResolvedStudy
    from mptune.params.valve_states import EdgeRule

_PAPER_EDGES = edge_rule((), Edges())
_PAPER_LINES = paper_table()


class SearchSpace(NamedTuple):
    """One side's states, S of them; both sides have the same."""

    valves: IntArray  # (S, W) 1 where a valve is open: those of a line in parallel, line by line
    first: IntArray  # (S,) a line that is connected
    first_count: FloatArray  # (S,) its open valves [K_v]
    second: IntArray  # (S,) the other line in crossflow
    second_count: FloatArray  # (S,) its open valves [K_v]; 0 without crossflow
    switches: FloatArray  # (S, S) valves that differ between two states
    lines: FloatArray  # (LINE_ROWS, L) the table of lines, see ``mptune.params.packed``
    edge: FloatArray  # (2, W) line and size [K_v] of each valve


def space_of(study: ResolvedStudy) -> SearchSpace:
    """Return the search space of a study's machine."""
    return search_space(study.study.edge_rule, pack_lines(study))


def search_space(edges: EdgeRule = _PAPER_EDGES, lines: FloatArray = _PAPER_LINES) -> SearchSpace:
    """Return the search space SS_A = SS_B.

    State 0 shuts all valves; the others follow kind by kind, see ``StateKind``. In the paper 1 to 6
    open both valves of one supply, 7 to 12 one valve of one, 13 to 17 one valve each of two
    neighbouring supplies, 18 to 27 two of one and one of the other.

    Parameters
    ----------
    edges
        The valves between each line and a chamber, and the kinds of states; the paper's by default.
    lines
        ``(LINE_ROWS, L)`` the table of lines; the paper's by default.
    """
    sizes = edges.sizes
    states = valve_states(edges)  # Eq. 6
    starts = np.cumsum([0, *(len(parallel) for parallel in sizes)])
    valves = np.zeros((len(states), starts[-1]), np.int64)
    ports = np.zeros((len(states), 2), np.int64)
    counts = np.zeros((len(states), 2))
    for row, state in enumerate(states):
        for place, (line, opened) in enumerate(state.items()):
            valves[row, starts[line] + np.array(opened)] = 1
            ports[row, place], counts[row, place] = line, sum(sizes[line][k] for k in opened)
    number_open = valves.sum(axis=1)
    switches = (number_open[:, None] + number_open - 2 * valves @ valves.T).astype(np.float64)
    first, second = (np.ascontiguousarray(column) for column in ports.T)
    first_count, second_count = (np.ascontiguousarray(column) for column in counts.T)
    edge = [(line, size) for line, parallel in enumerate(sizes) for size in parallel]
    table = np.ascontiguousarray(np.array(edge, np.float64).T)
    arrays = (valves, first, first_count, second, second_count, switches, lines, table)
    return SearchSpace(*(frozen(array) for array in arrays))
