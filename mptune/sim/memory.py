"""What the closed loop carries from tick to tick, and the order of its signals."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from mptune.arrays import FloatArray, IntArray, lending_kernel
from mptune.signals.states import OUTER_STATES

if TYPE_CHECKING:
    from mptune.plant.valve import ValveState

# Signals that are measured: position, both chamber pressures, highest and lowest line; then the
# converters, then the pressures of further chambers.
SIGNALS = 5
FIRST_CHAMBERS = 2  # whose signals and columns stand before the converters'
# Places in ``Memory.outer`` behind the outer loops' own: whether the stop logic holds the valves
# shut, whether the pump runs, and where the position sensor's hysteresis stands. An array more in
# ``Memory`` costs a tenth of the speed.
STOPPED, PUMPING, SENSED = range(OUTER_STATES, OUTER_STATES + 3)
OUTER_PLACES = OUTER_STATES + 3


class Memory(NamedTuple):
    """What machine and controller carry from tick to tick."""

    state: FloatArray  # (S + 4,) of the machine; S are used but with hoses as lines
    energy: FloatArray  # (8,) J
    valves: ValveState
    raw: FloatArray  # (2, 3 + K + C) the last two samples of each signal
    filtered: FloatArray  # (3 + K + C,)
    history: FloatArray  # (6,) filtered positions, newest first
    converters: FloatArray  # (K,) behind the backlash
    outer: FloatArray  # (OUTER_PLACES,) of the outer loops, and those above
    choice: IntArray  # (C,) valve states of the chambers, A and B first


@lending_kernel
def chamber_of_signal(signal: int, converters: int) -> int:
    """Return the chamber whose pressure a signal is; −1 of other signals."""
    if 1 <= signal <= FIRST_CHAMBERS:
        return signal - 1
    further = signal - SIGNALS - converters
    return FIRST_CHAMBERS + further if further >= 0 else -1
