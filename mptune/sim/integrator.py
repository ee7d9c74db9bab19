"""The machine advanced by the classical Runge-Kutta method, with valves that open and shut.

The step is fixed; valve ramps are sampled at a step's start, middle and end. Energies are
integrated by the same weights, so that they close as well as the states do.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, inlined_kernel, kernel, lending_kernel
from mptune.params.packed import OPEN_ROWS
from mptune.plant.machine import (
    CONVERTER,
    ENERGIES,
    LINE_STATES,
    PRESSURE_A,
    PRESSURE_B,
    VALVE_END_A,
    VALVE_END_B,
    V,
    X,
    rates,
    rates_with_lines,
    states_of,
)
from mptune.plant.piston import burden_at
from mptune.plant.valve import ValveState, advance, copy_open, open_valves, quiet

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.params.packed import Machine
    from mptune.plant.piston import Burden

SUBSTEPS, CALM_SUBSTEPS = 5, 2  # of the machine's integration in one tick of 0.5 ms
# A loop of known length is faster: that of the paper's machine. Shorter states have hose lines'
# behind them, which do not change.
_COMPILED = 9
_CALM = 1e4  # Pa over one tick: slower pressures are calm


class Work(NamedTuple):
    """Room for the integration: slopes, powers, and open valves at a step's start, middle, end."""

    k1: FloatArray  # (S + 4,) each, as the state
    k2: FloatArray
    k3: FloatArray
    k4: FloatArray
    ahead: FloatArray
    power: FloatArray  # (8,)
    start: FloatArray  # (OPEN_ROWS, L) each, the lines that have an open valve
    middle: FloatArray
    end: FloatArray
    lines: FloatArray  # (LINE_ROWS, L) all lines
    edge: FloatArray  # (2, W/2) line and size of each valve of a side


@kernel
def new_work(valves: ValveState, lines: FloatArray, edge: FloatArray, states: int) -> Work:
    """Return room for the integration, with the valves as they stand.

    Parameters
    ----------
    valves
        All valves.
    lines
        ``(LINE_ROWS, L)``, see ``mptune.params.packed``.
    edge
        ``(2, W/2)``, see ``mptune.plant.valve.open_valves``.
    states
        Length of the state.
    """
    size = OPEN_ROWS, lines.shape[1]
    work = Work(
        np.zeros(states),
        np.zeros(states),
        np.zeros(states),
        np.zeros(states),
        np.zeros(states),
        np.empty(ENERGIES),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        lines,
        edge,
    )
    for table in (work.start, work.middle, work.end):
        open_valves(valves, edge, lines, table)
    work.k4[PRESSURE_A] = np.inf  # nothing is calm before the first step
    return work


@lending_kernel
def integrate(
    state: FloatArray,
    energy: FloatArray,
    valves: ValveState,
    pumping: float,
    machine: Machine,
    table: FloatArray,
    ramp: float,
    now: float,
    span: float,
    work: Work,
) -> None:
    """Advance the machine over one tick.

    While no valve moves and the pressures hardly do, two steps are as good as five.

    Parameters
    ----------
    state, energy, valves
        ``(S + 4,)``, ``(8,)`` and the valves; carried on in place.
    pumping
        1 while the pump runs, else 0.
    machine, table
        The machine, and its boom's table.
    ramp
        How long a valve takes to open [s].
    now, span
        When the tick begins and how long it lasts [s].
    work
        Room, which remembers the valves and the last slopes.
    """
    burden = burden_at(state[X], machine, table)
    still = quiet(valves, now + span)
    rate = max(abs(work.k4[PRESSURE_A]), abs(work.k4[PRESSURE_B]))  # at the end of the last step
    substeps = CALM_SUBSTEPS if still and rate * span < _CALM else SUBSTEPS
    h = span / substeps
    for sub in range(substeps):
        at = now + sub * h
        moved = False
        if not still:
            moved = advance(valves, at, 0.5 * h, ramp)
            if moved:
                open_valves(valves, work.edge, work.lines, work.middle)
            moved = advance(valves, at + 0.5 * h, 0.5 * h, ramp) or moved
            if moved:
                open_valves(valves, work.edge, work.lines, work.end)
        if machine.line_inertance > 0:
            runge_kutta_with_lines(state, energy, pumping, machine, burden, h, work)
        else:
            runge_kutta(state, energy, pumping, machine, burden, h, work)
        if moved:
            copy_open(work.start, work.end)
            copy_open(work.middle, work.end)


@inlined_kernel
def _spend(energy: FloatArray, share: float, power: FloatArray) -> None:
    for i in range(ENERGIES):
        energy[i] += share * power[i]


def _stepper(slopes: Callable[..., None], more: int) -> Callable[..., None]:
    """Return one step of the classical Runge-Kutta method for a right-hand side of its own.

    ``more`` are the states that it has beyond the machine's own.
    """

    def step(
        state: FloatArray,
        energy: FloatArray,
        pumping: float,
        machine: Machine,
        burden: Burden,
        h: float,
        work: Work,
    ) -> None:
        k1, k2, k3, k4 = work.k1, work.k2, work.k3, work.k4
        ahead, power = work.ahead, work.power
        count = states_of(machine) + more
        slopes(state, work.start, pumping, machine, burden, k1, power)
        _spend(energy, h / 6, power)
        for i in range(_COMPILED):
            ahead[i] = state[i] + 0.5 * h * k1[i]
        for i in range(_COMPILED, count):
            ahead[i] = state[i] + 0.5 * h * k1[i]
        slopes(ahead, work.middle, pumping, machine, burden, k2, power)
        _spend(energy, h / 3, power)
        for i in range(_COMPILED):
            ahead[i] = state[i] + 0.5 * h * k2[i]
        for i in range(_COMPILED, count):
            ahead[i] = state[i] + 0.5 * h * k2[i]
        slopes(ahead, work.middle, pumping, machine, burden, k3, power)
        _spend(energy, h / 3, power)
        for i in range(_COMPILED):
            ahead[i] = state[i] + h * k3[i]
        for i in range(_COMPILED, count):
            ahead[i] = state[i] + h * k3[i]
        slopes(ahead, work.end, pumping, machine, burden, k4, power)
        _spend(energy, h / 6, power)
        for i in range(_COMPILED):
            state[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i])
        for i in range(_COMPILED, count):
            state[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i])
        _stops(state, machine)

    return step


@inlined_kernel
def _stops(state: FloatArray, machine: Machine) -> None:
    """Hold piston, converters and pressures inside what is physically possible."""
    if state[X] < 0 or state[X] > machine.stroke:
        state[X] = min(max(state[X], 0.0), machine.stroke)
        state[V] = 0.0
    state[PRESSURE_A] = max(state[PRESSURE_A], 0.0)
    state[PRESSURE_B] = max(state[PRESSURE_B], 0.0)
    if machine.line_inertance > 0:
        own = states_of(machine)
        state[own + VALVE_END_A] = max(state[own + VALVE_END_A], 0.0)
        state[own + VALVE_END_B] = max(state[own + VALVE_END_B], 0.0)
    for i in range(machine.converters):
        place = state[CONVERTER + i]
        state[CONVERTER + i] = min(max(place, -machine.converter_travel), machine.converter_travel)


runge_kutta = inlined_kernel(_stepper(rates, 0))
runge_kutta_with_lines = lending_kernel(_stepper(rates_with_lines, LINE_STATES))
