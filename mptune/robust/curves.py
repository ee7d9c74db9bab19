"""Whole curves of a family, for drawing; a sweep itself keeps envelopes only."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numba
import numpy as np

from mptune.arrays import ComplexArray, FloatArray, parallel_kernel
from mptune.loops.broken import loop_gain
from mptune.loops.position import position_error
from mptune.loops.velocity import plant_at, velocity_error

if TYPE_CHECKING:
    from mptune.loops.family import FamilyLoops
    from mptune.params.packed import LoopGains, MeasurementPath, NominalPlant, Plants


@parallel_kernel
def error_curves(
    omega: FloatArray,
    plants: Plants,
    nominal: NominalPlant,
    nominal_velocity_loop: ComplexArray,
) -> FloatArray:
    """Return |Δ_vel| and |Δ_pos| of every plant at every frequency, ``(2, N, F)``.

    ``nominal_velocity_loop`` ``(F,)`` is the loop gain of the nominal velocity loop.
    """
    count = len(plants.mass)
    curves = np.empty((2, count, len(omega)))
    for n in numba.prange(count):
        plant = plant_at(plants, n)
        for f in range(len(omega)):
            error = velocity_error(1j * omega[f], plant, nominal)
            curves[0, n, f] = abs(error)
            curves[1, n, f] = abs(position_error(error, nominal_velocity_loop[f]))
    return curves


def loop_curves(which: int, omega: FloatArray, loops: FamilyLoops) -> ComplexArray:
    """Return the loop gain of every plant at every frequency, ``(N, F)``.

    ``which`` is ``VELOCITY``, ``POSITION`` or ``FORCE``, wherever ``loops`` are broken.
    """
    return _loop_curves(which, omega, loops.plants, loops.gains, loops.path)


@parallel_kernel
def _loop_curves(
    which: int, omega: FloatArray, plants: Plants, gains: LoopGains, path: MeasurementPath
) -> ComplexArray:
    count = len(plants.mass)
    curves = np.empty((count, len(omega)), np.complex128)
    for n in numba.prange(count):
        plant = plant_at(plants, n)
        for f in range(len(omega)):
            curves[n, f] = loop_gain(which, 1j * omega[f], plant, gains, path)
    return curves
