"""Stability margins of every plant of a family, in the loop's three places, with dead time.

Peaks are refined between grid points by a golden section and crossings by bisection, so that the
grid only has to be fine enough to see each of them. A peak narrower than the grid can be missed,
which is optimistic; whether a loop is stable at all is decided elsewhere, by encirclements.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numba
import numpy as np

from mptune.arrays import ComplexArray, FloatArray, kernel, parallel_kernel
from mptune.loops.broken import FORCE, SAMPLED, closed_around, feedbacks
from mptune.loops.estimated import half_rate
from mptune.loops.sampled import (
    SampledPlant,
    coefficient_count,
    sampled_plant,
)
from mptune.loops.velocity import plant_at, true_velocity
from mptune.params.packed import Plant
from mptune.robust.crossings import FIGURES, JudgedPlant, gains_on, margins_of, note_factor
from mptune.summary import tuple_text

if TYPE_CHECKING:
    from mptune.loops.family import FamilyLoops
    from mptune.params.packed import LoopGains, MeasurementPath, Plants

_BEYOND = 40  # frequencies that continue the grid
_SHORTEST_DELAY = 1e-4  # s


class Margins(NamedTuple):
    """Margins of three loops (rows: velocity, position, force) of N plants, ``(3, N)`` each.

    Each figure is followed by its frequency [rad/s]. Where a margin has no limit it is infinite
    and its frequency NaN.
    """

    sensitivity_peak: FloatArray  # M_S = max |1/(1 + L)|
    sensitivity_frequency: FloatArray
    complementary_peak: FloatArray  # M_T = max |L/(1 + L)|
    complementary_frequency: FloatArray
    gain_margin: FloatArray  # smallest factor above 1 that reaches the critical point
    gain_frequency: FloatArray
    gain_reduction: FloatArray  # largest factor below 1 that reaches it; 0 where none does
    reduction_frequency: FloatArray
    phase_margin: FloatArray  # rad, the smaller of both directions
    phase_frequency: FloatArray
    delay_margin: FloatArray  # s, min over the crossovers of φ(ω)/ω
    delay_frequency: FloatArray
    disk_margin: FloatArray  # α = 1/max |(S − T)/2|, symmetric disk
    disk_frequency: FloatArray
    peak_compliance: FloatArray  # m/N, largest |S|/(mω²): of the loop at F_ref, NaN of the others
    compliance_frequency: FloatArray

    def __repr__(self) -> str:
        """Return shape and range of each field."""
        return tuple_text(self)


def family_margins(omega: FloatArray, loops: FamilyLoops) -> Margins:
    """Return the margins of every plant, from the frequencies ``omega`` ``(F,)`` refined.

    The grid is continued to where any loop with dead time d has turned by π once more, ω = 2π/d,
    so that no gain margin lies beyond it.
    """
    shortest = max(float(loops.plants.delay.min()), _SHORTEST_DELAY)
    beyond = max(float(omega[-1]), 2 * np.pi / shortest)
    wide = np.union1d(omega, np.geomspace(omega[-1], beyond, _BEYOND))
    if loops.path.estimator_mass > 0:  # taken up to half the fast rate
        wide = wide[wide <= half_rate(loops.path)]
    table = _family_margins(wide, loops.plants, loops.gains, loops.path)
    return Margins(*np.moveaxis(table, 2, 0))


@parallel_kernel
def _family_margins(
    omega: FloatArray, plants: Plants, gains: LoopGains, path: MeasurementPath
) -> FloatArray:
    count, points = len(plants.mass), len(omega)
    table = np.empty((3, count, FIGURES))
    sampled = SampledPlant(np.empty(0), np.empty(0), 0.0, 0.0, np.empty(0))
    shared = np.empty((2, points), np.complex128)
    for f in range(points):
        shared[0, f], shared[1, f] = feedbacks(1j * omega[f], gains, path)
    for n in numba.prange(count):
        none = np.empty(0), np.empty(0, np.complex128)
        plant = JudgedPlant(plant_at(plants, n), sampled, 0.0, none[0], none[1])
        velocity = np.empty(points, np.complex128)
        for f in range(points):
            velocity[f] = true_velocity(1j * omega[f], plant.true)
        for which in range(3):
            if path.estimator_mass > 0:  # it hears the plant's force: nothing is shared
                loop = gains_on(which, omega, plant, gains, path)
            else:
                loop = _shared_loop(which, omega, velocity, shared, gains.k_p_vel)
            table[which, n, :] = margins_of(which, omega, loop, plant, gains, path)
    return table


@kernel
def _shared_loop(
    which: int,
    omega: FloatArray,
    velocity: ComplexArray,
    shared: ComplexArray,
    k_p_vel: float,
) -> ComplexArray:
    """Return a plant's loop gain on a grid, ``(F,)``, from the ``feedbacks`` there ``(2, F)``."""
    loop = np.empty(len(omega), np.complex128)
    for f in range(len(omega)):
        loop[f] = closed_around(
            which, 1j * omega[f], velocity[f], shared[0, f], shared[1, f], k_p_vel
        )
    return loop


def sampled_margins(omega: FloatArray, loops: FamilyLoops, period: float) -> Margins:
    """Return the margins of every plant's loop at F_ref as it runs, sampled at ``period`` [s].

    They stand in the row of the force loop; the other two rows are NaN, and so is the delay margin:
    a sampled loop has no such single figure. The frequencies ``omega`` ``(F,)`` are taken up to
    half the sampling rate, above which the loop repeats itself.
    """
    half_rate = np.pi / period
    grid = np.union1d(omega[omega < half_rate], np.linspace(0.02, 1, 50) * half_rate)
    table = np.full((3, loops.plants.number, FIGURES), np.nan)
    table[FORCE] = _sampled_margins(grid, loops.plants, loops.gains, loops.path, period)
    table[:, :, 10:12] = np.nan
    return Margins(*np.moveaxis(table, 2, 0))


@parallel_kernel
def _sampled_margins(
    omega: FloatArray, plants: Plants, gains: LoopGains, path: MeasurementPath, period: float
) -> FloatArray:
    size = coefficient_count(plants.delay.max(), path, period)
    table = np.empty((len(plants.mass), FIGURES))
    for n in numba.prange(len(plants.mass)):
        true = plant_at(plants, n)
        sampled = sampled_plant(true, path, period, size)
        plant = JudgedPlant(true, sampled, period, np.empty(0), np.empty(0, np.complex128))
        loop = gains_on(SAMPLED, omega, plant, gains, path)
        row = margins_of(SAMPLED, omega, loop, plant, gains, path)
        end = loop[-1].real  # real at half the rate
        if end < 0:
            note_factor(row, -1 / end, omega[-1])
        table[n, :] = row
    return table


def measured_margins(
    omega: FloatArray, force: ComplexArray, mass: float, gains: LoopGains, path: MeasurementPath
) -> FloatArray:
    """Return the margins of the three loops around one measured force response, ``(3, FIGURES)``.

    In the order of ``Margins``, within the band of the fine grid ``omega`` ``(F,)``. Between its
    points the response ``force`` ``(F,)`` is taken to go straight: the error is that of the square
    of the step.
    """
    return np.asarray(_measured_margins(omega, force, mass, gains, path))


@kernel
def _measured_margins(
    omega: FloatArray, force: ComplexArray, mass: float, gains: LoopGains, path: MeasurementPath
) -> FloatArray:
    sampled = SampledPlant(np.empty(0), np.empty(0), 0.0, 0.0, np.empty(0))
    plant = JudgedPlant(Plant(mass, 0.0, 0.0, 0.0, 0.5), sampled, 0.0, omega, force)
    table = np.empty((3, FIGURES))
    for which in range(3):
        loop = gains_on(which, omega, plant, gains, path)
        table[which] = margins_of(which, omega, loop, plant, gains, path)
    return table
