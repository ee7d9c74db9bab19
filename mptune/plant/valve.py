"""On/off valves: each with a pure delay, drawn anew at each switching, and an opening ramp."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mptune.arrays import FloatArray, IntArray, lending_kernel
from mptune.params.packed import LINE_ROWS, OPEN_A, OPEN_B

SIDES = 2
PENDING = 8  # commands that may be under way to one valve


class ValveState(NamedTuple):
    """Where every valve stands and what is under way to it."""

    opening: FloatArray  # (W,) 0 shut … 1 open; all valves of side A, then those of side B
    target: FloatArray  # (W,) where the opening is heading
    commanded: FloatArray  # (W,) the last command given
    due: FloatArray  # (W, PENDING) s, when a pending command takes hold; inf where none
    wanted: FloatArray  # (W, PENDING) the pending command
    busy: IntArray  # (W,) valves that move or wait for a command, the first ``counters[1]``
    counters: IntArray  # (2 + W,) switches so far, busy valves, and the switches of each valve


_PAPER_VALVES = 24  # two in parallel between each of six lines and two chambers


def shut_valves(number: int = _PAPER_VALVES) -> ValveState:
    """Return so many valves that are shut, with nothing under way."""
    zero = np.zeros(number)
    return ValveState(
        zero,
        zero.copy(),
        zero.copy(),
        np.full((number, PENDING), np.inf),
        np.zeros((number, PENDING)),
        np.zeros(number, np.int64),
        np.zeros(2 + number, np.int64),
    )


@lending_kernel
def command(valves: ValveState, valve: int, wanted: float, due: float) -> None:
    """Give a valve a new command that takes hold at time ``due`` [s].

    A later command never overtakes an earlier one: it takes hold at the earliest with it, and then
    wins.
    """
    if valves.commanded[valve] == wanted:
        return
    valves.commanded[valve] = wanted
    valves.counters[0] += 1
    valves.counters[2 + valve] += 1
    place = 0
    for k in range(PENDING):
        if np.isfinite(valves.due[valve, k]):
            place = k + 1
            due = max(due, valves.due[valve, k])
    place = min(place, PENDING - 1)  # of too many, the latest command still wins
    valves.due[valve, place] = due
    valves.wanted[valve, place] = wanted
    for k in range(valves.counters[1]):
        if valves.busy[k] == valve:
            return
    valves.busy[valves.counters[1]] = valve
    valves.counters[1] += 1


@lending_kernel
def advance(valves: ValveState, time: float, step: float, ramp: float) -> bool:
    """Move all valves from ``time`` over ``step`` [s]; return whether any moved.

    A command that falls due within the step starts its ramp at that instant.
    """
    moved = False
    still_busy = 0
    for k in range(valves.counters[1]):
        valve = valves.busy[k]
        moved = _advance_one(valves, valve, time, step, ramp) or moved
        if valves.opening[valve] != valves.target[valve] or np.isfinite(valves.due[valve, 0]):
            valves.busy[still_busy] = valve
            still_busy += 1
    valves.counters[1] = still_busy
    return moved


@lending_kernel
def quiet(valves: ValveState, until: float) -> bool:
    """Return whether no valve moves, or starts to, before ``until`` [s]."""
    for k in range(valves.counters[1]):
        valve = valves.busy[k]
        if valves.opening[valve] != valves.target[valve] or valves.due[valve, 0] <= until:
            return False
    return True


@lending_kernel
def _advance_one(valves: ValveState, valve: int, time: float, step: float, ramp: float) -> bool:
    moved = False
    now, end = time, time + step
    while valves.due[valve, 0] <= end:
        at = max(valves.due[valve, 0], now)
        moved = _ramp(valves, valve, at - now, ramp) or moved
        now = at
        valves.target[valve] = valves.wanted[valve, 0]
        for k in range(PENDING - 1):
            valves.due[valve, k] = valves.due[valve, k + 1]
            valves.wanted[valve, k] = valves.wanted[valve, k + 1]
        valves.due[valve, PENDING - 1] = np.inf
    return _ramp(valves, valve, end - now, ramp) or moved


@lending_kernel
def _ramp(valves: ValveState, valve: int, step: float, ramp: float) -> bool:
    gap = valves.target[valve] - valves.opening[valve]
    if gap == 0:
        return False
    change = step / ramp
    if abs(gap) <= change:
        valves.opening[valve] = valves.target[valve]
    else:
        valves.opening[valve] += np.copysign(change, gap)
    return True


@lending_kernel
def open_valves(
    valves: ValveState, edge: FloatArray, lines: FloatArray, opened: FloatArray
) -> None:
    """Fill the table of lines that have an open valve.

    Parameters
    ----------
    valves
        Where every valve stands.
    edge
        ``(2, W/2)`` line and size [K_v] of each valve of a side, line by line.
    lines
        ``(LINE_ROWS, L)``, see ``mptune.params.packed``.
    opened
        ``(OPEN_ROWS, L)``, filled.
    """
    each, found, k = edge.shape[1], 0, 0
    for line in range(lines.shape[1]):
        open_a = open_b = 0.0
        while k < each and edge[0, k] == line:
            open_a += edge[1, k] * valves.opening[k]
            open_b += edge[1, k] * valves.opening[each + k]
            k += 1
        if open_a != 0 or open_b != 0:
            add_open(line, open_a, open_b, found, lines, opened)
            found += 1
    if found < opened.shape[1]:
        opened[OPEN_A, found] = opened[OPEN_B, found] = 0.0


@lending_kernel
def add_open(
    line: int, open_a: float, open_b: float, place: int, lines: FloatArray, opened: FloatArray
) -> None:
    """Fill one column of the table of open lines; see ``open_valves``."""
    for row in range(LINE_ROWS):
        opened[row, place] = lines[row, line]
    opened[OPEN_A, place], opened[OPEN_B, place] = open_a, open_b


@lending_kernel
def copy_open(opened: FloatArray, source: FloatArray) -> None:
    """Fill a table of open lines from another."""
    for row in range(opened.shape[0]):
        for place in range(opened.shape[1]):
            opened[row, place] = source[row, place]
