"""The one-step-ahead estimator of chamber pressure (§2.2)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import FloatArray, kernel
from mptune.plant.bulk import effective_bulk_modulus
from mptune.plant.flow import orifice

if TYPE_CHECKING:
    from mptune.params.packed import ForceSettings

STEPS = 4  # Heun steps in one sampling period
SIDE_A, SIDE_B = 0, 1


@kernel
def stiffness(side: int, position: float, settings: ForceSettings) -> float:
    """Return B̂_eff over volume of one chamber at a piston position [Pa/m³]."""
    if side == SIDE_A:
        volume = settings.area_a * position + settings.dead_a
        hose = settings.hose_a
    else:
        volume = settings.area_b * (settings.stroke - position) + settings.dead_b
        hose = settings.hose_b
    modulus: float = effective_bulk_modulus(settings.oil, settings.hose, hose, volume)
    return modulus / volume


@kernel
def displaced(side: int, velocity: float, settings: ForceSettings) -> float:
    """Return the flow that the piston's motion takes from a chamber [m³/s]."""
    return settings.area_a * velocity if side == SIDE_A else -settings.area_b * velocity


@kernel
def stiffness_path(
    side: int, position: float, velocity: float, period: float, settings: ForceSettings
) -> FloatArray:
    """Return ``stiffness`` at the ends of the four steps, ``(5,)``: the same for every state."""
    path = np.empty(STEPS + 1)
    for k in range(STEPS + 1):
        path[k] = stiffness(side, position + velocity * period * k / STEPS, settings)
    return path


@kernel
def predict(
    pressure: float,
    supply_1: float,
    count_1: float,
    supply_2: float,
    count_2: float,
    taken: float,
    path: FloatArray,
    period: float,
    settings: ForceSettings,
) -> float:
    """Return the pressure after ``period`` with a valve state held [Pa].

    Velocity and supply pressures are taken as constant.

    Parameters
    ----------
    pressure
        Pressure now [Pa].
    supply_1, supply_2
        Pressures of the connected supplies [Pa].
    count_1, count_2
        Open valves towards them.
    taken
        ``displaced`` [m³/s].
    path
        ``stiffness_path`` ``(5,)``.
    period
        T_S, or another time to look ahead [s].
    settings
        The controller's knowledge.
    """
    step = period / STEPS
    scale, tr = settings.flow_coefficient, settings.transition_pressure
    for k in range(STEPS):
        flow = count_1 * orifice(supply_1 - pressure, tr)
        if count_2 > 0:
            flow += count_2 * orifice(supply_2 - pressure, tr)
        slope_1 = path[k] * (scale * flow - taken)
        ahead = pressure + step * slope_1
        flow = count_1 * orifice(supply_1 - ahead, tr)
        if count_2 > 0:
            flow += count_2 * orifice(supply_2 - ahead, tr)
        slope_2 = path[k + 1] * (scale * flow - taken)
        pressure += 0.5 * step * (slope_1 + slope_2)  # Eq. 5
    return pressure
