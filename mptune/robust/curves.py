"""Whole curves of a family, for drawing; a sweep itself keeps envelopes only."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numba
import numpy as np

from mptune.arrays import ComplexArray, FloatArray, parallel_kernel
from mptune.loops.broken import loop_gain
from mptune.loops.position import position_error
from mptune.loops.velocity import velocity_error

if TYPE_CHECKING:
    from mptune.params.pack import LoopGains, MeasurementPath, NominalPlant, Plants


@parallel_kernel
def error_curves(
    omega: FloatArray,
    plants: Plants,
    nominal: NominalPlant,
    share_a: float,
    nominal_velocity_loop: ComplexArray,
) -> FloatArray:
    """Return |Δ_vel| and |Δ_pos| of every plant at every frequency, ``(2, N, F)``.

    ``nominal_velocity_loop`` ``(F,)`` is the loop gain of the nominal velocity loop.
    """
    count = len(plants.mass)
    curves = np.empty((2, count, len(omega)))
    for n in numba.prange(count):
        for f in range(len(omega)):
            error = velocity_error(
                1j * omega[f],
                plants.mass[n],
                plants.delay[n],
                plants.tau_a[n],
                plants.tau_b[n],
                share_a,
                nominal.mass,
                nominal.delay,
            )
            curves[0, n, f] = abs(error)
            curves[1, n, f] = abs(position_error(error, nominal_velocity_loop[f]))
    return curves


@parallel_kernel
def loop_curves(
    which: int,
    omega: FloatArray,
    plants: Plants,
    share_a: float,
    gains: LoopGains,
    path: MeasurementPath,
) -> ComplexArray:
    """Return the loop gain of every plant at every frequency, ``(N, F)``."""
    count = len(plants.mass)
    curves = np.empty((count, len(omega)), np.complex128)
    for n in numba.prange(count):
        for f in range(len(omega)):
            curves[n, f] = loop_gain(
                which,
                1j * omega[f],
                plants.mass[n],
                plants.delay[n],
                plants.tau_a[n],
                plants.tau_b[n],
                share_a,
                gains,
                path,
            )
    return curves
