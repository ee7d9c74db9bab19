"""Stability margins of every plant of a family, in the loop's three places, with dead time.

Peaks are refined between grid points by a golden section and crossings by bisection, so that the
grid only has to be fine enough to see each of them. A peak narrower than the grid can be missed,
which is optimistic; whether a loop is stable at all is decided elsewhere, by encirclements.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numba
import numpy as np

from mptune.arrays import Complex, ComplexArray, FloatArray, kernel, parallel_kernel
from mptune.loops.broken import FORCE, SAMPLED, loop_around, loop_gain
from mptune.loops.sampled import (
    SampledPlant,
    coefficient_count,
    sampled_loop,
    sampled_plant,
)
from mptune.loops.velocity import plant_at
from mptune.params.pack import Plant
from mptune.summary import tuple_text

if TYPE_CHECKING:
    from mptune.loops.family import FamilyLoops
    from mptune.params.pack import LoopGains, MeasurementPath, Plants

_GOLDEN = (5**0.5 - 1) / 2
_BEYOND = 40  # frequencies that continue the grid
_SHORTEST_DELAY = 1e-4  # s
_NEARLY = 0.4  # of the highest grid value: lower peaks are not refined
_PEAK_STEPS = 25  # of a golden section: 6e-6 of the grid step, 1e-11 of a smooth peak
_CROSSING_STEPS = 40  # of a bisection: 1e-12 of the grid step
_SENSITIVITY, _COMPLEMENTARY, _DISK = 0, 1, 2


class _Plant(NamedTuple):
    """One plant of Eq. 15; as the controller samples it, or as its force response was measured.

    What is not asked for is empty.
    """

    true: Plant
    sampled: SampledPlant
    period: float  # s, T_S
    omega: FloatArray  # (F,) rad/s, where the force response is known
    force: ComplexArray  # (F,) the force response there


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
    table = _family_margins(wide, loops.plants, loops.gains, loops.path)
    return Margins(*np.moveaxis(table, 2, 0))


@parallel_kernel
def _family_margins(
    omega: FloatArray, plants: Plants, gains: LoopGains, path: MeasurementPath
) -> FloatArray:
    count = len(plants.mass)
    table = np.empty((3, count, 14))
    sampled = SampledPlant(np.empty(0), np.empty(0), 0.0, 0.0, 0.0)
    for n in numba.prange(count):
        none = np.empty(0), np.empty(0, np.complex128)
        plant = _Plant(plant_at(plants, n), sampled, 0.0, none[0], none[1])
        for which in range(3):
            table[which, n, :] = _margins(which, omega, plant, gains, path)
    return table


def sampled_margins(omega: FloatArray, loops: FamilyLoops, period: float) -> Margins:
    """Return the margins of every plant's loop at F_ref as it runs, sampled at ``period`` [s].

    They stand in the row of the force loop; the other two rows are NaN, and so is the delay margin:
    a sampled loop has no such single figure. The frequencies ``omega`` ``(F,)`` are taken up to
    half the sampling rate, above which the loop repeats itself.
    """
    half_rate = np.pi / period
    grid = np.union1d(omega[omega < half_rate], np.linspace(0.02, 1, 50) * half_rate)
    table = np.full((3, loops.plants.number, 14), np.nan)
    table[FORCE] = _sampled_margins(grid, loops.plants, loops.gains, loops.path, period)
    table[:, :, 10:12] = np.nan
    return Margins(*np.moveaxis(table, 2, 0))


@parallel_kernel
def _sampled_margins(
    omega: FloatArray, plants: Plants, gains: LoopGains, path: MeasurementPath, period: float
) -> FloatArray:
    size = coefficient_count(plants.delay.max(), path, period)
    table = np.empty((len(plants.mass), 14))
    for n in numba.prange(len(plants.mass)):
        true = plant_at(plants, n)
        sampled = sampled_plant(true, path, period, size)
        plant = _Plant(true, sampled, period, np.empty(0), np.empty(0, np.complex128))
        row = _margins(SAMPLED, omega, plant, gains, path)
        end = sampled_loop(1j * omega[-1], sampled, gains, period).real  # real at half the rate
        if end < 0:
            _note_factor(row, -1 / end, omega[-1])
        table[n, :] = row
    return table


def measured_margins(
    omega: FloatArray, force: ComplexArray, mass: float, gains: LoopGains, path: MeasurementPath
) -> FloatArray:
    """Return the margins of the three loops around one measured force response, ``(3, 14)``.

    In the order of ``Margins``, within the band of the fine grid ``omega`` ``(F,)``. Between its
    points the response ``force`` ``(F,)`` is taken to go straight: the error is that of the square
    of the step.
    """
    return np.asarray(_measured_margins(omega, force, mass, gains, path))


@kernel
def _measured_margins(
    omega: FloatArray, force: ComplexArray, mass: float, gains: LoopGains, path: MeasurementPath
) -> FloatArray:
    sampled = SampledPlant(np.empty(0), np.empty(0), 0.0, 0.0, 0.0)
    plant = _Plant(Plant(mass, 0.0, 0.0, 0.0, 0.5), sampled, 0.0, omega, force)
    table = np.empty((3, 14))
    for which in range(3):
        table[which] = _margins(which, omega, plant, gains, path)
    return table


@kernel
def _gain(
    which: int,
    omega: float,
    plant: _Plant,
    gains: LoopGains,
    path: MeasurementPath,
) -> Complex:
    s = 1j * omega
    if which == SAMPLED:
        return sampled_loop(s, plant.sampled, gains, plant.period)
    if len(plant.omega) > 0:
        force = _between(omega, plant.omega, plant.force)
        return loop_around(which, s, force / (plant.true.mass * s), gains, path)
    return loop_gain(which, s, plant.true, gains, path)


@kernel
def _between(omega: float, grid: FloatArray, values: ComplexArray) -> Complex:
    """Return a value on the chord between two neighbouring points."""
    below = int(np.searchsorted(grid, omega)) - 1
    low = min(max(below, 0), len(grid) - 2)
    share = (omega - grid[low]) / (grid[low + 1] - grid[low])
    return values[low] + share * (values[low + 1] - values[low])


@kernel
def _size(kind: int, gain: complex) -> float:
    """Return |S|, |T| or |S − T|/2 of a loop gain."""
    if kind == _SENSITIVITY:
        return 1 / abs(1 + gain)
    if kind == _COMPLEMENTARY:
        return abs(gain / (1 + gain))
    return 0.5 * abs((1 - gain) / (1 + gain))


@kernel
def _margins(
    which: int,
    omega: FloatArray,
    plant: _Plant,
    gains: LoopGains,
    path: MeasurementPath,
) -> FloatArray:
    points = len(omega)
    loop = np.empty(points, np.complex128)
    size = np.empty((3, points))
    for f in range(points):
        loop[f] = _gain(which, omega[f], plant, gains, path)
        for kind in range(3):
            size[kind, f] = _size(kind, loop[f])
    row = np.full(14, np.nan)
    for kind in range(3):
        peak, at = _highest_peak(kind, which, omega, size[kind], plant, gains, path)
        column = 12 if kind == _DISK else 2 * kind
        row[column] = 1 / peak if kind == _DISK else peak
        row[column + 1] = at
    row[4], row[6], row[8], row[10] = np.inf, 0.0, np.inf, np.inf
    for f in range(points - 1):
        if (loop[f].imag < 0) != (loop[f + 1].imag < 0):
            _note_gain_crossing(row, which, omega[f], omega[f + 1], plant, gains, path)
        if (abs(loop[f]) > 1) != (abs(loop[f + 1]) > 1):
            _note_phase_crossing(row, which, omega[f], omega[f + 1], plant, gains, path)
    return row


@kernel
def _highest_peak(
    kind: int,
    which: int,
    omega: FloatArray,
    size: FloatArray,
    plant: _Plant,
    gains: LoopGains,
    path: MeasurementPath,
) -> tuple[float, float]:
    """Return the highest value and its frequency, having refined every peak that may hold it."""
    last = len(omega) - 1
    top = np.argmax(size)
    height, at = size[top], omega[top]
    floor = _NEARLY * height
    for f in range(last + 1):
        if size[f] < floor or size[f] < size[min(f + 1, last)]:
            continue
        if f > 0 and size[f] <= size[f - 1]:  # falling, or within a level stretch
            continue
        place = _peak(
            kind, which, omega[max(f - 1, 0)], omega[min(f + 1, last)], plant, gains, path
        )
        value = _size(kind, _gain(which, place, plant, gains, path))
        if value > height:
            height, at = value, place
    return height, at


@kernel
def _peak(
    kind: int,
    which: int,
    low: float,
    high: float,
    plant: _Plant,
    gains: LoopGains,
    path: MeasurementPath,
) -> float:
    """Return the frequency of the peak of |S|, |T| or |S − T| between two frequencies."""
    left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    at_left = _size(kind, _gain(which, left, plant, gains, path))
    at_right = _size(kind, _gain(which, right, plant, gains, path))
    for _ in range(_PEAK_STEPS):
        if at_left > at_right:
            high, right, at_right = right, left, at_left
            left = high - _GOLDEN * (high - low)
            at_left = _size(kind, _gain(which, left, plant, gains, path))
        else:
            low, left, at_left = left, right, at_right
            right = low + _GOLDEN * (high - low)
            at_right = _size(kind, _gain(which, right, plant, gains, path))
    return 0.5 * (low + high)


@kernel
def _note_gain_crossing(
    row: FloatArray,
    which: int,
    low: float,
    high: float,
    plant: _Plant,
    gains: LoopGains,
    path: MeasurementPath,
) -> None:
    """Note the gain margin where L crosses the real axis, if left of the origin."""
    below = _gain(which, low, plant, gains, path).imag < 0
    for _ in range(_CROSSING_STEPS):
        middle = 0.5 * (low + high)
        if (_gain(which, middle, plant, gains, path).imag < 0) == below:
            low = middle
        else:
            high = middle
    at = 0.5 * (low + high)
    crossing = _gain(which, at, plant, gains, path).real
    if crossing >= 0:
        return
    _note_factor(row, -1 / crossing, at)


@kernel
def _note_factor(row: FloatArray, factor: float, at: float) -> None:
    """Note a factor of the gain that reaches the critical point."""
    if factor >= 1 and factor < row[4]:
        row[4], row[5] = factor, at
    if factor < 1 and factor > row[6]:
        row[6], row[7] = factor, at


@kernel
def _note_phase_crossing(
    row: FloatArray,
    which: int,
    low: float,
    high: float,
    plant: _Plant,
    gains: LoopGains,
    path: MeasurementPath,
) -> None:
    """Note phase and delay margin where |L| crosses 1."""
    above = abs(_gain(which, low, plant, gains, path)) > 1
    for _ in range(_CROSSING_STEPS):
        middle = 0.5 * (low + high)
        if (abs(_gain(which, middle, plant, gains, path)) > 1) == above:
            low = middle
        else:
            high = middle
    at = 0.5 * (low + high)
    gain = _gain(which, at, plant, gains, path)
    lag = (np.arctan2(gain.imag, gain.real) + np.pi) % (2 * np.pi)  # to reach −1 by lagging
    phase = min(lag, 2 * np.pi - lag)
    if phase < row[8]:
        row[8], row[9] = phase, at
    if lag / at < row[10]:
        row[10], row[11] = lag / at, at
