"""Digital flow control by the steady state: which valves give the speed that is wanted.

With a supply at p_S, the tank at 0 and a force F, the piston settles at

    s² = (A_in p_S − F)/(A_in³/K_in² + A_out³/K_out²)

between an inlet of K_in and an outlet of K_out. Every pair is tried. Inertia and compressibility
are not seen, so that nothing damps the oil spring: the speed errs where the force changes fast.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import kernel
from mptune.systems.switching import ones

if TYPE_CHECKING:
    from mptune.arrays import FloatArray

LEVELS = 32  # of an edge: five valves, 1:2:4:8:16


class SpeedWeights(NamedTuple):
    """What the decision weighs beside the error of the speed [m/s]."""

    back_pressure: float  # Pa, wanted in the chamber of lower pressure
    pressure: float  # m/(s Pa)
    switching: float  # m/s


@kernel
def settled(
    supply: float, force: float, area_in: float, area_out: float, inlet: float, outlet: float
) -> tuple[float, float, float]:
    """Return the steady speed [m/s] and the pressures of the fed and the drained chamber [Pa].

    The speed is 0 where the supply cannot move the load.
    """
    resistance_in, resistance_out = (area_in / inlet) ** 2, (area_out / outlet) ** 2
    excess = area_in * supply - force
    squared = excess / (area_in * resistance_in + area_out * resistance_out)
    if squared <= 0:
        return 0.0, supply, 0.0
    return math.sqrt(squared), supply - resistance_in * squared, resistance_out * squared


@kernel
def cheapest_pair(
    speed: float,
    supply: float,
    force: float,
    area_in: float,
    area_out: float,
    edge: float,
    present_in: int,
    present_out: int,
    others: int,
    weights: SpeedWeights,
) -> tuple[int, int]:
    """Return the levels of inlet and outlet, 0 to 31, with the least cost.

    Parameters
    ----------
    speed
        Wanted, at least 0 [m/s].
    supply, force
        p_S [Pa] and what the piston pushes against in the direction of motion [N].
    area_in, area_out
        Of the fed and the drained chamber [m²].
    edge
        Flow coefficient of a whole edge [m³/(s Pa^0.5)].
    present_in, present_out
        The levels now.
    others
        Valves that have to be shut on the other edges in any case, switches of which count alike.
    weights
        Of the drained pressure and of switches.
    """
    unit = edge / (LEVELS - 1)
    best = speed + weights.switching * (ones(present_in) + ones(present_out) + others)
    best_in, best_out = 0, 0
    for inlet in range(1, LEVELS):
        changed = ones(inlet ^ present_in) + others
        for outlet in range(1, LEVELS):
            found, fed, drained = settled(
                supply, force, area_in, area_out, unit * inlet, unit * outlet
            )
            cost = abs(speed - found)
            cost += weights.pressure * abs(min(fed, drained) - weights.back_pressure)
            cost += weights.switching * (changed + ones(outlet ^ present_out))
            if cost < best:
                best, best_in, best_out = cost, inlet, outlet
    return best_in, best_out


def level_weights() -> FloatArray:
    """Return what each valve of the four edges is worth ``(4, 5)``, of a whole edge."""
    return np.tile(2.0 ** np.arange(5) / (LEVELS - 1), (4, 1))
