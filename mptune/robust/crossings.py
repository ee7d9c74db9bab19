"""Margins of one loop gain: its peaks and crossings, refined between the points of a grid."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import Complex, ComplexArray, FloatArray, kernel
from mptune.loops.broken import FORCE, SAMPLED, loop_around, loop_gain
from mptune.loops.sampled import SampledPlant, sampled_loop

if TYPE_CHECKING:
    from mptune.params.packed import LoopGains, MeasurementPath, Plant

_GOLDEN = (5**0.5 - 1) / 2
_NEARLY = 0.4  # of the highest grid value: lower peaks are not refined
_PEAK_STEPS = 25  # of a golden section: 6e-6 of the grid step, 1e-11 of a smooth peak
_CROSSING_STEPS = 40  # of a bisection: 1e-12 of the grid step
_SENSITIVITY, _COMPLEMENTARY, _DISK, _COMPLIANCE = 0, 1, 2, 3
_COLUMN = (0, 2, 12, 14)  # of each kind of peak
FIGURES = 16  # a margin or peak and its frequency, by turns


class JudgedPlant(NamedTuple):
    """One plant of Eq. 15; as the controller samples it, or as its force response was measured.

    What is not asked for is empty.
    """

    true: Plant
    sampled: SampledPlant
    period: float  # s, T_S
    omega: FloatArray  # (F,) rad/s, where the force response is known
    force: ComplexArray  # (F,) the force response there


@kernel
def gain_at(
    which: int,
    omega: float,
    plant: JudgedPlant,
    gains: LoopGains,
    path: MeasurementPath,
) -> Complex:
    """Return the loop gain at jω, in whichever form the plant is known."""
    s = 1j * omega
    if which == SAMPLED:
        return sampled_loop(s, plant.sampled, gains, plant.period)
    if len(plant.omega) > 0:
        force = _between(omega, plant.omega, plant.force)
        mass = plant.true.mass
        return loop_around(which, s, force / (mass * s), mass, gains, path)
    return loop_gain(which, s, plant.true, gains, path)


@kernel
def _between(omega: float, grid: FloatArray, values: ComplexArray) -> Complex:
    """Return a value on the chord between two neighbouring points."""
    below = int(np.searchsorted(grid, omega)) - 1
    low = min(max(below, 0), len(grid) - 2)
    share = (omega - grid[low]) / (grid[low + 1] - grid[low])
    return values[low] + share * (values[low + 1] - values[low])


@kernel
def _size(kind: int, gain: complex, omega: float, mass: float) -> float:
    """Return |S|, |T|, |S − T|/2 or |S|/(mω²) of a loop gain."""
    if kind == _SENSITIVITY:
        return 1 / abs(1 + gain)
    if kind == _COMPLEMENTARY:
        return abs(gain / (1 + gain))
    if kind == _COMPLIANCE:
        return 1 / (abs(1 + gain) * mass * omega * omega)
    return 0.5 * abs((1 - gain) / (1 + gain))


@kernel
def _size_at(
    kind: int,
    which: int,
    omega: float,
    plant: JudgedPlant,
    gains: LoopGains,
    path: MeasurementPath,
) -> float:
    gain = gain_at(which, omega, plant, gains, path)
    return _size(kind, gain, omega, plant.true.mass)


@kernel
def gains_on(
    which: int,
    omega: FloatArray,
    plant: JudgedPlant,
    gains: LoopGains,
    path: MeasurementPath,
) -> ComplexArray:
    """Return the loop gain on a grid, ``(F,)``."""
    loop = np.empty(len(omega), np.complex128)
    for f in range(len(omega)):
        loop[f] = gain_at(which, omega[f], plant, gains, path)
    return loop


@kernel
def margins_of(
    which: int,
    omega: FloatArray,
    loop: ComplexArray,
    plant: JudgedPlant,
    gains: LoopGains,
    path: MeasurementPath,
) -> FloatArray:
    """Return the margins of one loop in the order of ``Margins``, ``(FIGURES,)``.

    ``loop`` ``(F,)`` is its gain at ``omega``, see ``gains_on``.
    """
    points = len(omega)
    kinds = 4 if which in (FORCE, SAMPLED) else 3  # compliance is the whole loop's
    size = np.empty((kinds, points))
    for f in range(points):
        for kind in range(kinds):
            size[kind, f] = _size(kind, loop[f], omega[f], plant.true.mass)
    row = np.full(FIGURES, np.nan)
    for kind in range(kinds):
        peak, at = _highest_peak(kind, which, omega, size[kind], plant, gains, path)
        column = _COLUMN[kind]
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
    plant: JudgedPlant,
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
        value = _size_at(kind, which, place, plant, gains, path)
        if value > height:
            height, at = value, place
    return height, at


@kernel
def _peak(
    kind: int,
    which: int,
    low: float,
    high: float,
    plant: JudgedPlant,
    gains: LoopGains,
    path: MeasurementPath,
) -> float:
    """Return the frequency of a peak of ``_size`` between two frequencies."""
    left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    at_left = _size_at(kind, which, left, plant, gains, path)
    at_right = _size_at(kind, which, right, plant, gains, path)
    for _ in range(_PEAK_STEPS):
        if at_left > at_right:
            high, right, at_right = right, left, at_left
            left = high - _GOLDEN * (high - low)
            at_left = _size_at(kind, which, left, plant, gains, path)
        else:
            low, left, at_left = left, right, at_right
            right = low + _GOLDEN * (high - low)
            at_right = _size_at(kind, which, right, plant, gains, path)
    return 0.5 * (low + high)


@kernel
def _note_gain_crossing(
    row: FloatArray,
    which: int,
    low: float,
    high: float,
    plant: JudgedPlant,
    gains: LoopGains,
    path: MeasurementPath,
) -> None:
    """Note the gain margin where L crosses the real axis, if left of the origin."""
    below = gain_at(which, low, plant, gains, path).imag < 0
    for _ in range(_CROSSING_STEPS):
        middle = 0.5 * (low + high)
        if (gain_at(which, middle, plant, gains, path).imag < 0) == below:
            low = middle
        else:
            high = middle
    at = 0.5 * (low + high)
    crossing = gain_at(which, at, plant, gains, path).real
    if crossing >= 0:
        return
    note_factor(row, -1 / crossing, at)


@kernel
def note_factor(row: FloatArray, factor: float, at: float) -> None:
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
    plant: JudgedPlant,
    gains: LoopGains,
    path: MeasurementPath,
) -> None:
    """Note phase and delay margin where |L| crosses 1."""
    above = abs(gain_at(which, low, plant, gains, path)) > 1
    for _ in range(_CROSSING_STEPS):
        middle = 0.5 * (low + high)
        if (abs(gain_at(which, middle, plant, gains, path)) > 1) == above:
            low = middle
        else:
            high = middle
    at = 0.5 * (low + high)
    gain = gain_at(which, at, plant, gains, path)
    lag = (np.arctan2(gain.imag, gain.real) + np.pi) % (2 * np.pi)  # to reach −1 by lagging
    phase = min(lag, 2 * np.pi - lag)
    if phase < row[8]:
        row[8], row[9] = phase, at
    if lag / at < row[10]:
        row[10], row[11] = lag / at, at
