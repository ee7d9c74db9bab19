"""The machine advanced by the classical Runge-Kutta method, with valves that open and shut.

The step is fixed; valve ramps are sampled at a step's start, middle and end. Energies are
integrated by the same weights, so that they close as well as the states do.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, inlined_kernel, kernel, lending_kernel
from mptune.params.packed import LINE_ROWS, OPEN_ROWS, SUBSTEPS
from mptune.plant.chamber_valves import open_valves_of_chambers
from mptune.plant.chambers import further_states, place_of, rates_of_chambers
from mptune.plant.hoses import LINE_STATES, rates_with_lines
from mptune.plant.machine import (
    CONVERTER,
    ENERGIES,
    PRESSURE_A,
    PRESSURE_B,
    V,
    X,
    rates,
    states_of,
)
from mptune.plant.piston import burden_at
from mptune.plant.valve import ValveState, advance, copy_open, open_valves, quiet

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.params.packed import Machine, MoreChambers
    from mptune.plant.piston import Burden

CALM_SUBSTEPS = 2  # instead of SUBSTEPS
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
    start: FloatArray  # (OPEN_ROWS, L) each, the lines that have an open valve; see ``opening``
    middle: FloatArray
    end: FloatArray
    lines: FloatArray  # (LINE_ROWS, L) all lines
    edge: FloatArray  # (2, W/2) line and size of each valve of a side


@lending_kernel
def opening(
    valves: ValveState,
    edge: FloatArray,
    lines: FloatArray,
    opened: FloatArray,
    more: MoreChambers | None = None,
) -> None:
    """Fill a table of open valves: as two chambers read it, or as more of them do."""
    if more is None:
        open_valves(valves, edge, lines, opened)
    else:
        open_valves_of_chambers(valves, edge, lines, more.table, opened)


@kernel
def new_work(
    valves: ValveState,
    lines: FloatArray,
    edge: FloatArray,
    states: int,
    more: MoreChambers | None = None,
) -> Work:
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
    more
        The machine's chambers where there are more than two.
    """
    rows = OPEN_ROWS
    if more is not None:
        rows = LINE_ROWS + more.table.shape[1]
    size = rows, lines.shape[1]
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
        opening(valves, edge, lines, table, more)
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
    more: MoreChambers | None = None,
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
    more
        The machine's chambers where there are more than two.
    """
    burden = burden_at(state[X], machine, table)
    still = quiet(valves, now + span)
    rate = max(abs(work.k4[PRESSURE_A]), abs(work.k4[PRESSURE_B]))  # at the end of the last step
    if more is not None:
        for i in range(more.table.shape[1]):
            rate = max(rate, abs(work.k4[place_of(i, machine)]))
    substeps = CALM_SUBSTEPS if still and rate * span < _CALM else SUBSTEPS
    h = span / substeps
    for sub in range(substeps):
        at = now + sub * h
        moved = False
        if not still:
            moved = advance(valves, at, 0.5 * h, ramp)
            if moved:
                opening(valves, work.edge, work.lines, work.middle, more)
            moved = advance(valves, at + 0.5 * h, 0.5 * h, ramp) or moved
            if moved:
                opening(valves, work.edge, work.lines, work.end, more)
        if more is not None:
            runge_kutta_of_chambers(state, energy, pumping, machine, burden, h, work, more.table)
        elif machine.line_inertance > 0:
            runge_kutta_with_lines(state, energy, pumping, machine, burden, h, work, None)
        else:
            runge_kutta(state, energy, pumping, machine, burden, h, work, None)
        if moved:
            copy_open(work.start, work.end)
            copy_open(work.middle, work.end)


@inlined_kernel
def _spend(energy: FloatArray, share: float, power: FloatArray) -> None:
    for i in range(ENERGIES):
        energy[i] += share * power[i]


@inlined_kernel
def _no_more(_chambers: FloatArray | None) -> tuple[int, int]:
    return 0, 0


@inlined_kernel
def _of_two_lines(_chambers: FloatArray | None) -> tuple[int, int]:
    return LINE_STATES, LINE_STATES // 2


def _stepper(
    slopes: Callable[..., None], further: Callable[..., tuple[int, int]]
) -> Callable[..., None]:
    """Return one step of the classical Runge-Kutta method for a right-hand side of its own.

    ``further`` gives how many states it has beyond the machine's own, and how many of them, the
    first, are pressures.
    """

    def step(
        state: FloatArray,
        energy: FloatArray,
        pumping: float,
        machine: Machine,
        burden: Burden,
        h: float,
        work: Work,
        chambers: FloatArray | None,
    ) -> None:
        k1, k2, k3, k4 = work.k1, work.k2, work.k3, work.k4
        ahead, power = work.ahead, work.power
        more, pressures = further(chambers)
        count = states_of(machine) + more
        slopes(state, work.start, pumping, machine, burden, k1, power, chambers)
        _spend(energy, h / 6, power)
        for i in range(_COMPILED):
            ahead[i] = state[i] + 0.5 * h * k1[i]
        for i in range(_COMPILED, count):
            ahead[i] = state[i] + 0.5 * h * k1[i]
        slopes(ahead, work.middle, pumping, machine, burden, k2, power, chambers)
        _spend(energy, h / 3, power)
        for i in range(_COMPILED):
            ahead[i] = state[i] + 0.5 * h * k2[i]
        for i in range(_COMPILED, count):
            ahead[i] = state[i] + 0.5 * h * k2[i]
        slopes(ahead, work.middle, pumping, machine, burden, k3, power, chambers)
        _spend(energy, h / 3, power)
        for i in range(_COMPILED):
            ahead[i] = state[i] + h * k3[i]
        for i in range(_COMPILED, count):
            ahead[i] = state[i] + h * k3[i]
        slopes(ahead, work.end, pumping, machine, burden, k4, power, chambers)
        _spend(energy, h / 6, power)
        for i in range(_COMPILED):
            state[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i])
        for i in range(_COMPILED, count):
            state[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i])
        _stops(state, machine, pressures)

    return step


@inlined_kernel
def _stops(state: FloatArray, machine: Machine, further: int) -> None:
    """Hold piston, converters and pressures inside what is physically possible."""
    if state[X] < 0 or state[X] > machine.stroke:
        state[X] = min(max(state[X], 0.0), machine.stroke)
        state[V] = 0.0
    state[PRESSURE_A] = max(state[PRESSURE_A], 0.0)
    state[PRESSURE_B] = max(state[PRESSURE_B], 0.0)
    own = states_of(machine)
    for i in range(own, own + further):
        state[i] = max(state[i], 0.0)
    for i in range(machine.converters):
        place = state[CONVERTER + i]
        state[CONVERTER + i] = min(max(place, -machine.converter_travel), machine.converter_travel)


runge_kutta = inlined_kernel(_stepper(rates, _no_more))
runge_kutta_with_lines = lending_kernel(_stepper(rates_with_lines, _of_two_lines))
runge_kutta_of_chambers = lending_kernel(_stepper(rates_of_chambers, further_states))
