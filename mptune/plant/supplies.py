"""The supply pressures: accumulator, pump, tank line and converter cylinders (Fig. 1).

The lowest line is the tank side, the highest has the accumulator, or a constant pressure without
one; those between are constant or made by converters. Flow drawn from a converter's port moves its
piston, and a share α of that flow comes from one line, the rest from another, so that its pressure
stands at that share between the two, but for friction, see ``mptune.plant.port``.
``mptune.params.packed`` has the table of lines.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mptune.arrays import inlined_kernel

if TYPE_CHECKING:
    from mptune.params.packed import Machine


@inlined_kernel
def line_pressure(base: float, share: float, high: float) -> float:
    """Return the pressure of a line without friction [Pa], the highest line's being ``high``."""
    return base + share * (high - base)


@inlined_kernel
def accumulator_pressure(oil: float, machine: Machine) -> float:
    """Return p_HP [Pa] with ``oil`` [m³] in the accumulator; the gas is polytropic.

    Without an accumulator the state in its place is the pressure itself.
    """
    if machine.accumulator_volume <= 0:
        return oil
    gas = machine.accumulator_volume - max(oil, 0.0)
    compression: float = (machine.accumulator_volume / gas) ** machine.accumulator_exponent
    return machine.accumulator_precharge * compression


def oil_at_pressure(pressure: float, machine: Machine) -> float:
    """Return the oil in the accumulator [m³] at a pressure [Pa] above its precharge.

    Without an accumulator it is the pressure, as in ``accumulator_pressure``.
    """
    if machine.accumulator_volume <= 0:
        return pressure
    ratio = machine.accumulator_precharge / pressure
    return machine.accumulator_volume * (1 - math.pow(ratio, 1 / machine.accumulator_exponent))
