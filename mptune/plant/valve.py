"""On/off valves: each with a pure delay, drawn anew at each switching, and an opening ramp."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mptune.arrays import FloatArray, IntArray, kernel

VALVES = 24  # 12 per side: two in parallel for each of six supplies
PENDING = 8  # commands that may be under way to one valve


class ValveState(NamedTuple):
    """Where every valve stands and what is under way to it."""

    opening: FloatArray  # (24,) 0 shut … 1 open
    target: FloatArray  # (24,) where the opening is heading
    commanded: FloatArray  # (24,) the last command given
    due: FloatArray  # (24, PENDING) s, when a pending command takes hold; inf where none
    wanted: FloatArray  # (24, PENDING) the pending command
    busy: IntArray  # (24,) valves that move or wait for a command, the first ``counters[1]``
    counters: IntArray  # (26,) switches so far, busy valves, and the switches of each valve


def shut_valves() -> ValveState:
    """Return valves that are shut, with nothing under way."""
    zero = np.zeros(VALVES)
    return ValveState(
        zero,
        zero.copy(),
        zero.copy(),
        np.full((VALVES, PENDING), np.inf),
        np.zeros((VALVES, PENDING)),
        np.zeros(VALVES, np.int64),
        np.zeros(2 + VALVES, np.int64),
    )


@kernel
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


@kernel
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


@kernel
def quiet(valves: ValveState, until: float) -> bool:
    """Return whether no valve moves, or starts to, before ``until`` [s]."""
    for k in range(valves.counters[1]):
        valve = valves.busy[k]
        if valves.opening[valve] != valves.target[valve] or valves.due[valve, 0] <= until:
            return False
    return True


@kernel
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


@kernel
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


@kernel
def open_valves(valves: ValveState, open_a: FloatArray, open_b: FloatArray) -> None:
    """Fill ``(6,)`` arrays with the open valves between each supply and each chamber."""
    for supply in range(6):
        open_a[supply] = valves.opening[2 * supply] + valves.opening[2 * supply + 1]
        open_b[supply] = valves.opening[12 + 2 * supply] + valves.opening[13 + 2 * supply]
