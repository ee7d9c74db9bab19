"""Margins of the loop as it runs for a search: signed, quick, of the plants that it asks.

What ``mptune.robust.margins`` finds for a verdict is found here from responses that the gains leave
alone. What a load does to the position is |1 + L_F||S|/(mω²), L_F being the part of the loop gain
that the estimator hears of the force, which knows nothing of a load; without one there is none.
Margins carry the sign of stability and so pass smoothly through zero where a loop becomes
unstable. Peaks are refined by parabolas and crossings by the secant method: to about 1e-7 of a
figure whose peak the grid sees; a narrower one can be missed, which is optimistic.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import Complex, ComplexArray, FloatArray, Real, kernel
from mptune.loops.running import force_part, running_family, runs_stable, sampled_at
from mptune.loops.sampled import sampled_loop
from mptune.signals.tustin import discrete_response, discretise

if TYPE_CHECKING:
    from mptune.loops.family import FamilyLoops
    from mptune.loops.running import RunningFamily
    from mptune.loops.sampled import SampledPlant
    from mptune.params.packed import LoopGains

_SENSITIVITY, _DISK, _COMPLIANCE = 0, 1, 2
_IMAGINARY, _MODULUS = 0, 1  # kinds of crossing: Im L = 0, |L| = 1
_NEARLY = 0.7  # of the highest grid value: lower peaks are not refined
_PARABOLAS, _SECANTS = 4, 12
_BLOCK = 2000  # plants whose responses are kept at a time
_STABLE, _GAIN, _PHASE, _DELAY, _COLUMNS = 6, 7, 9, 11, 13


class RunningFigures(NamedTuple):
    """Figures of N loops as they run, ``(N,)`` each; a frequency [rad/s] behind each but one."""

    sensitivity_peak: FloatArray  # M_S
    sensitivity_frequency: FloatArray
    disk_margin: FloatArray  # α; −α where the loop is unstable
    disk_frequency: FloatArray
    peak_compliance: FloatArray  # m/N, largest |1 + L_F||S|/(mω²)
    compliance_frequency: FloatArray
    stable: FloatArray  # 1 or 0
    gain_margin: FloatArray  # least factor above 1; largest below 1 where unstable
    gain_frequency: FloatArray
    phase_margin: FloatArray  # rad; negative where unstable
    phase_frequency: FloatArray
    delay_margin: FloatArray  # s, min φ/ω, as if every alias turned alike; negative where unstable
    delay_frequency: FloatArray


def family_figures(loops: FamilyLoops, period: float, low: float) -> RunningFigures:
    """Return the figures of every plant of a family that is asked once.

    Parameters
    ----------
    loops
        The plants, the gains, and the measurement path as it runs.
    period
        T_S [s].
    low
        The lowest frequency [rad/s].
    """
    plants, parts = loops.plants, []
    for first in range(0, plants.number, _BLOCK):
        some = plants.picked(np.arange(first, min(first + _BLOCK, plants.number)))
        family = running_family(low, some, loops.path, period)
        parts.append(_figures(family, loops.gains))
    return RunningFigures(*np.concatenate(parts).T)


def running_figures(family: RunningFamily, gains: LoopGains) -> RunningFigures:
    """Return the figures of every plant of a family."""
    return RunningFigures(*_figures(family, gains).T)


@kernel
def _figures(family: RunningFamily, gains: LoopGains) -> FloatArray:
    omega, period = family.omega, family.period
    points, law = len(omega), discretise(gains, period)
    shape = np.empty(points, np.complex128)
    for f in range(points):
        turn = np.exp(-1j * omega[f] * period)
        shape[f] = discrete_response(law, turn)
    loop, size = np.empty(points, np.complex128), np.empty((3, points))
    table = np.empty((len(family.mass), _COLUMNS))
    for n in range(len(family.mass)):
        mass = family.mass[n]
        for f in range(points):
            heard = family.velocity_at[n, f] + shape[f] * family.position_at[n, f]
            loop[f] = gains.k_p_vel * heard
            force = family.force_at[1, n, f] + shape[f] * family.force_at[0, n, f]
            for kind in range(3):
                size[kind, f] = _size(kind, loop[f], gains.k_p_vel * force, omega[f], mass)
        plant, by_force = sampled_at(family, n), force_part(family, n)
        for kind in range(3):
            peak, at = _peak(kind, omega, size[kind], mass, plant, by_force, gains, period)
            table[n, 2 * kind], table[n, 2 * kind + 1] = peak, at
        stable = runs_stable(family, n, gains)
        table[n, _STABLE] = 1.0 if stable else 0.0
        _note_crossings(table[n], stable, omega, loop, plant, gains, period)
        table[n, 2 * _DISK] = (1 if stable else -1) / table[n, 2 * _DISK]
    return table


@kernel
def _size(kind: int, gain: Complex, force: Complex, omega: float, mass: float) -> Real:
    """Return |S|, |S − T|/2 or |1 + L_F||S|/(mω²) of a loop gain, and its part L_F."""
    if kind == _DISK:
        return 0.5 * abs((1 - gain) / (1 + gain))
    size = 1 / abs(1 + gain)
    return abs(1 + force) * size / (mass * omega * omega) if kind == _COMPLIANCE else size


@kernel
def _peak(
    kind: int,
    omega: FloatArray,
    size: FloatArray,
    mass: float,
    plant: SampledPlant,
    by_force: SampledPlant,
    gains: LoopGains,
    period: float,
) -> tuple[float, float]:
    """Return the highest value and its frequency, every peak that may hold it refined."""
    last = len(omega) - 1
    top = np.argmax(size)
    height, at = size[top], omega[top]
    floor = _NEARLY * height
    for f in range(1, last):
        if size[f] < floor or size[f] < size[f + 1] or size[f] <= size[f - 1]:
            continue
        x = (omega[f - 1], omega[f], omega[f + 1])
        y = (-(size[f - 1] ** -2), -(size[f] ** -2), -(size[f + 1] ** -2))  # nearly a parabola
        for _ in range(_PARABOLAS):
            place = _vertex(x, y)
            gain = sampled_loop(1j * place, plant, gains, period)
            force = 0j * gain
            if kind == _COMPLIANCE:
                force = sampled_loop(1j * place, by_force, gains, period)
            value = _size(kind, gain, force, place, mass)
            if value > height:
                height, at = value, place
            x, y = _narrowed(x, y, place, -(value**-2))
    return height, at


@kernel
def _vertex(x: tuple[float, float, float], y: tuple[float, float, float]) -> float:
    """Return where the parabola through three points, the middle one highest, has its top."""
    left, right = x[1] - x[0], x[2] - x[1]
    fall, rise = y[1] - y[0], y[1] - y[2]
    both = right * fall + left * rise
    if not both > 0:
        return x[1]
    place = x[1] + 0.5 * (right * right * fall - left * left * rise) / both
    least = 1e-3 * (x[2] - x[0])
    if abs(place - x[1]) < 1e-9 * x[1]:  # beside it, so that the bracket narrows
        return x[1] + least if right > left else x[1] - least
    return min(max(place, x[0]), x[2])


@kernel
def _narrowed(
    x: tuple[float, float, float], y: tuple[float, float, float], place: float, value: float
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Return the three points about the highest, one more being known."""
    if value > y[1]:
        if place > x[1]:
            return (x[1], place, x[2]), (y[1], value, y[2])
        return (x[0], place, x[1]), (y[0], value, y[1])
    if place > x[1]:
        return (x[0], x[1], place), (y[0], y[1], value)
    return (place, x[1], x[2]), (value, y[1], y[2])


@kernel
def _note_crossings(
    row: FloatArray,
    stable: Real,
    omega: FloatArray,
    loop: ComplexArray,
    plant: SampledPlant,
    gains: LoopGains,
    period: float,
) -> None:
    """Note gain, phase and delay margin of one loop."""
    row[_GAIN], row[_PHASE], row[_DELAY] = (np.inf if stable else 0.0), np.inf, np.inf
    row[_GAIN + 1], row[_PHASE + 1], row[_DELAY + 1] = np.nan, np.nan, np.nan
    last = len(omega) - 1
    for f in range(last):
        if loop[f].imag * loop[f + 1].imag < 0:
            at = _crossing(_IMAGINARY, omega[f], omega[f + 1], loop[f], loop[f + 1],
                           plant, gains, period)  # fmt: skip
            _note_factor(row, stable, sampled_loop(1j * at, plant, gains, period).real, at)
        if (abs(loop[f]) - 1) * (abs(loop[f + 1]) - 1) < 0:
            at = _crossing(_MODULUS, omega[f], omega[f + 1], loop[f], loop[f + 1],
                           plant, gains, period)  # fmt: skip
            gain = sampled_loop(1j * at, plant, gains, period)
            lag = (np.arctan2(gain.imag, gain.real) + np.pi) % (2 * np.pi)
            phase = min(lag, 2 * np.pi - lag)
            if phase < row[_PHASE]:
                row[_PHASE], row[_PHASE + 1] = phase, at
            if stable and lag / at < row[_DELAY]:
                row[_DELAY], row[_DELAY + 1] = lag / at, at
            if not stable and (2 * np.pi - lag) / at < row[_DELAY]:  # what less delay would mend
                row[_DELAY], row[_DELAY + 1] = (2 * np.pi - lag) / at, at
    _note_factor(row, stable, loop[last].real, omega[last])  # real at half the sampling rate
    if not stable:
        row[_PHASE], row[_DELAY] = -row[_PHASE], -row[_DELAY]


@kernel
def _note_factor(row: FloatArray, stable: Real, real: float, at: float) -> None:
    """Note a factor of the gain that reaches the critical point."""
    if real >= 0:
        return
    factor = -1 / real
    nearer = 1 <= factor < row[_GAIN] if stable else row[_GAIN] < factor < 1
    if nearer:
        row[_GAIN], row[_GAIN + 1] = factor, at


@kernel
def _crossing(
    kind: int,
    low: float,
    high: float,
    at_low: Complex,
    at_high: Complex,
    plant: SampledPlant,
    gains: LoopGains,
    period: float,
) -> float:
    """Return where ln|L| or Im L is zero between two frequencies, by the Illinois method."""
    below = np.log(abs(at_low)) if kind == _MODULUS else at_low.imag
    above = np.log(abs(at_high)) if kind == _MODULUS else at_high.imag
    side, at = 0, low
    for _ in range(_SECANTS):
        at = (low * above - high * below) / (above - below)
        gain = sampled_loop(1j * at, plant, gains, period)
        value = np.log(abs(gain)) if kind == _MODULUS else gain.imag
        if value == 0 or high - low < 1e-12 * high:
            break
        if (value < 0) == (above < 0):
            high, above = at, value
            below = below / 2 if side == 1 else below
            side = 1
        else:
            low, below = at, value
            above = above / 2 if side == -1 else above
            side = -1
    return at
