"""The machine advanced by the classical Runge-Kutta method, with valves that open and shut.

The step is fixed; valve ramps are sampled at a step's start, middle and end. Energies are
integrated by the same weights, so that they close as well as the states do.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, inlined_kernel, kernel
from mptune.plant.machine import (
    CONVERTER,
    ENERGIES,
    LINE_STATES,
    PRESSURE_A,
    PRESSURE_B,
    STATES,
    VALVE_END_A,
    VALVE_END_B,
    V,
    X,
    rates,
    rates_with_lines,
)
from mptune.plant.piston import burden_at
from mptune.plant.valve import ValveState, advance, open_valves, quiet

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.params.packed import Machine
    from mptune.plant.piston import Burden

SUBSTEPS, CALM_SUBSTEPS = 5, 2  # of the machine's integration in one tick of 0.5 ms
_CALM = 1e4  # Pa over one tick: slower pressures are calm


class Work(NamedTuple):
    """Room for the integration: slopes, powers, and open valves at a step's start, middle, end."""

    k1: FloatArray  # (9,)
    k2: FloatArray
    k3: FloatArray
    k4: FloatArray
    ahead: FloatArray
    power: FloatArray  # (8,)
    start_a: FloatArray  # (6,)
    start_b: FloatArray
    middle_a: FloatArray
    middle_b: FloatArray
    end_a: FloatArray
    end_b: FloatArray


@kernel
def new_work(valves: ValveState) -> Work:
    """Return room for the integration, with the valves as they stand."""
    work = Work(
        np.zeros(LINE_STATES),
        np.zeros(LINE_STATES),
        np.zeros(LINE_STATES),
        np.full(LINE_STATES, np.inf),  # nothing is calm before the first step
        np.zeros(LINE_STATES),
        np.empty(ENERGIES),
        np.empty(6),
        np.empty(6),
        np.empty(6),
        np.empty(6),
        np.empty(6),
        np.empty(6),
    )
    open_valves(valves, work.start_a, work.start_b)
    open_valves(valves, work.middle_a, work.middle_b)
    open_valves(valves, work.end_a, work.end_b)
    return work


@kernel
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
        ``(13,)``, ``(8,)`` and the valves; carried on in place.
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
                open_valves(valves, work.middle_a, work.middle_b)
            moved = advance(valves, at + 0.5 * h, 0.5 * h, ramp) or moved
            if moved:
                open_valves(valves, work.end_a, work.end_b)
        if machine.line_inertance > 0:
            runge_kutta_with_lines(state, energy, pumping, machine, burden, h, work)
        else:
            runge_kutta(state, energy, pumping, machine, burden, h, work)
        if moved:
            open_valves(valves, work.start_a, work.start_b)
            open_valves(valves, work.middle_a, work.middle_b)


@inlined_kernel
def _spend(energy: FloatArray, share: float, power: FloatArray) -> None:
    for i in range(ENERGIES):
        energy[i] += share * power[i]


def _stepper(slopes: Callable[..., None], count: int) -> Callable[..., None]:
    """Return one step of the classical Runge-Kutta method for a right-hand side of its own."""

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
        slopes(state, work.start_a, work.start_b, pumping, machine, burden, k1, power)
        _spend(energy, h / 6, power)
        for i in range(count):
            ahead[i] = state[i] + 0.5 * h * k1[i]
        slopes(ahead, work.middle_a, work.middle_b, pumping, machine, burden, k2, power)
        _spend(energy, h / 3, power)
        for i in range(count):
            ahead[i] = state[i] + 0.5 * h * k2[i]
        slopes(ahead, work.middle_a, work.middle_b, pumping, machine, burden, k3, power)
        _spend(energy, h / 3, power)
        for i in range(count):
            ahead[i] = state[i] + h * k3[i]
        slopes(ahead, work.end_a, work.end_b, pumping, machine, burden, k4, power)
        _spend(energy, h / 6, power)
        for i in range(count):
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
        state[VALVE_END_A] = max(state[VALVE_END_A], 0.0)
        state[VALVE_END_B] = max(state[VALVE_END_B], 0.0)
    for i in range(4):
        place = state[CONVERTER + i]
        state[CONVERTER + i] = min(max(place, -machine.converter_travel), machine.converter_travel)


runge_kutta = inlined_kernel(_stepper(rates, STATES))
runge_kutta_with_lines = kernel(_stepper(rates_with_lines, LINE_STATES))
