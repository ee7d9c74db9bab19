"""Eq. 17 and Eq. 21: one robust-stability condition, two loops.

Left side: the largest multiplicative error over the family. Right side: |(1 + L_N)/L_N| of the
nominal loop. Their ratio is at most 1 where the condition holds; its inverse is the margin.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numba
import numpy as np

from mptune.arrays import ComplexArray, FloatArray, IntArray, kernel, parallel_kernel
from mptune.loops.broken import position_loop, velocity_loop
from mptune.loops.position import position_error
from mptune.loops.velocity import nominal_velocity, velocity_error

if TYPE_CHECKING:
    from mptune.params.pack import LoopGains, MeasurementPath, NominalPlant, Plants

_BLOCKS = 16  # of frequencies; fixed, so that results do not depend on the number of cores


class Sides(NamedTuple):
    """Both sides of Eq. 17 (row 0) and Eq. 21 (row 1) over a family."""

    left: FloatArray  # (2, F) envelope max |Δ| over the plants
    plant: IntArray  # (2, F) the plant behind each value of the envelope
    right: FloatArray  # (2, F) |(1 + L_N)/L_N|
    plant_ratio: FloatArray  # (2, N) largest left/right ratio of each plant
    plant_frequency: IntArray  # (2, N) the frequency behind it

    @property
    def ratio(self) -> FloatArray:
        """``(2, F)``: left over right."""
        return np.asarray(self.left / self.right)


@kernel
def nominal_loops(
    omega: FloatArray, nominal: NominalPlant, gains: LoopGains, path: MeasurementPath
) -> ComplexArray:
    """Return the nominal loop gains at jω, ``(2, F)``: velocity loop, position loop."""
    loops = np.empty((2, len(omega)), np.complex128)
    for f in range(len(omega)):
        s = 1j * omega[f]
        velocity = nominal_velocity(s, nominal.mass, nominal.delay)
        loops[0, f] = velocity_loop(s, velocity, gains.k_p_vel, path)
        loops[1, f] = position_loop(s, velocity, gains, path)
    return loops


def sides(
    omega: FloatArray,
    plants: Plants,
    nominal: NominalPlant,
    share_a: float,
    gains: LoopGains,
    path: MeasurementPath,
) -> Sides:
    """Return both sides of Eq. 17 and Eq. 21 at the frequencies ``omega``, ``(F,)`` [rad/s]."""
    loops = nominal_loops(omega, nominal, gains, path)
    right = np.abs((1 + loops) / loops)  # Eq. 17 and Eq. 21, right-hand sides
    errors = family_errors(omega, plants, nominal, share_a, loops[0], 1 / right)
    left, plant, block_ratio, block_frequency = errors
    block = np.argmax(block_ratio, axis=1)  # (2, N)
    ratio = np.take_along_axis(block_ratio, block[:, None], axis=1)[:, 0]
    frequency = np.take_along_axis(block_frequency, block[:, None], axis=1)[:, 0]
    return Sides(np.sqrt(left), plant, right, np.sqrt(ratio), frequency)


@parallel_kernel
def family_errors(
    omega: FloatArray,
    plants: Plants,
    nominal: NominalPlant,
    share_a: float,
    nominal_velocity_loop: ComplexArray,
    weight: FloatArray,
) -> tuple[FloatArray, IntArray, FloatArray, IntArray]:
    """Return the squared envelopes of |Δ_vel| and |Δ_pos| and each plant's worst ratio, squared.

    Parameters
    ----------
    omega
        ``(F,)`` frequencies [rad/s].
    plants, nominal, share_a
        The family ``(N,)``, the nominal plant and A_A/(A_A + A_B).
    nominal_velocity_loop
        ``(F,)`` loop gain of the nominal velocity loop.
    weight
        ``(2, F)`` inverse of the right-hand sides.

    Returns
    -------
    tuple
        Envelopes ``(2, F)``, plants behind them ``(2, F)``; worst ratios per block of frequencies
        ``(2, B, N)`` and the frequencies behind them ``(2, B, N)``.
    """
    points, count = len(omega), len(plants.mass)
    left = np.zeros((2, points))
    plant = np.zeros((2, points), np.int64)
    ratio = np.zeros((2, _BLOCKS, count))
    frequency = np.zeros((2, _BLOCKS, count), np.int64)
    for block in numba.prange(_BLOCKS):
        for f in range(block * points // _BLOCKS, (block + 1) * points // _BLOCKS):
            s = 1j * omega[f]
            square = weight[0, f] ** 2, weight[1, f] ** 2
            for n in range(count):
                velocity = velocity_error(
                    s,
                    plants.mass[n],
                    plants.delay[n],
                    plants.tau_a[n],
                    plants.tau_b[n],
                    share_a,
                    nominal.mass,
                    nominal.delay,
                )
                position = position_error(velocity, nominal_velocity_loop[f])
                for loop in range(2):
                    error = velocity if loop == 0 else position
                    size = error.real**2 + error.imag**2
                    if size > left[loop, f]:
                        left[loop, f] = size
                        plant[loop, f] = n
                    if size * square[loop] > ratio[loop, block, n]:
                        ratio[loop, block, n] = size * square[loop]
                        frequency[loop, block, n] = f
    return left, plant, ratio, frequency
