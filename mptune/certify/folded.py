"""What a finite sum leaves out of the loop as it runs around a state estimator.

The estimator repeats itself with the fast rate Ω, and hears at its multiples what it hears at the
loop's own frequencies: those aliases, the folds, fall with G_F and the hold alone. Left out of L up
to a frequency ω is at most ::

    |1 − w|/T_S Σ [ K/m̂ |G_F| (|v̂_F| + |C||x̂_F|)/|ω_k| + K/m (|v̂_x| + |C||x̂_x|)/|ω_k|³ ]

Folds are left out altogether, and with them all beyond the first, with |G_F| ≤ a/|ω_k τ_A| +
(1 − a)/|ω_k τ_B| at the least τ of the box at hand: where the lags are long, as where the loop has
least to spare, that is next to nothing. Below the first fold aliases beyond ±K are left out, with
|G_F| ≤ 1 where that is less. Where a τ is zero nothing bounds the folds: a force that follows at
once jumps with the hold, and is sampled as it jumps.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.certify.balls import modulus
from mptune.certify.estimated import floor_of, responses
from mptune.loops.estimated import slowest_error

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.certify.form import Form
    from mptune.params.packed import MeasurementPath

_PERIODS = 50  # of the fast rate: aliases are bounded one by one, beyond them together
_PARTS = 48  # of the frequencies up to one, each enclosed
_CARE = 1 + 1e-9


class LeftOut(NamedTuple):
    """What is left out of L up to a frequency, for plants of the largest mass ratio of a box.

    With g = a/τ_A + (1 − a)/τ_B at the least τ asked about it is at most
    ``fixed`` + min(``near``, g·``near_rate``) + g·``rate``.
    """

    fixed: float
    near: float
    near_rate: float  # s
    rate: float  # s


NOTHING = LeftOut(0.0, 0.0, 0.0, 0.0)


def unfolded_shifts(count: int, path: MeasurementPath, period: float) -> FloatArray:
    """Return the frequencies of the terms above ω [rad/s]: k = 0, 1, −1, …, without folds."""
    ticks = round(period / path.sample_time)
    order = [0, *(sign * k for k in range(1, count + 1) if k % ticks for sign in (1, -1))]
    return 2 * np.pi / period * np.array(order, np.float64)


def left_out_of(
    form: Form, ratio: float, count: int, omega: float, change: float, law: float
) -> LeftOut:
    """Return what the terms beyond ±``count`` and all folds add to L at most.

    Parameters
    ----------
    form, ratio, count, omega
        As of ``mptune.certify.sampled.remainder``.
    change, law
        Bounds of |1 − w| and of |(1 − w)C|.
    """
    slow = 2 * math.pi / form.period
    speed, place, speed_x, place_x = _highest(form.path, omega)
    near, near_rate, far, beside = _sums(form.path, slow, count, omega)
    far += _fold_sum(form.path, omega, 2) * np.array([speed, place])
    beside += _fold_sum(form.path, omega, 3) * np.array([speed_x, place_x])
    weights = np.array([change, law])
    gain = _CARE * form.gains.k_p_vel / form.period
    of_force = gain / form.path.estimator_mass
    return LeftOut(
        float(gain * ratio / form.nominal.mass * (weights @ beside)),
        *(float(of_force * (weights @ one)) for one in (near, near_rate, far)),
    )


def _fold_sum(path: MeasurementPath, omega: float, power: int) -> float:
    """Return Σ 1/|ω_k|^power over all folds of frequencies up to ``omega``, ω itself left out."""
    fast = 2 * math.pi / path.sample_time
    found = 2 / (fast**power * (_PERIODS - 0.5) ** (power - 1))
    for m in range(1, _PERIODS + 1):
        found += 1 / (m * fast - omega) ** power + 1 / (m * fast) ** power
    return found


@lru_cache(maxsize=256)
def _highest(path: MeasurementPath, omega: float) -> tuple[float, float, float, float]:
    """Return bounds of m̂v̂/F, m̂x̂/F, v̂/x and x̂/x at frequencies up to ``omega``, enclosed."""
    found, half, floor = np.zeros(4), 0.5 * omega / _PARTS, floor_of(path)
    for part in range(_PARTS):
        known = responses(path, (2 * part + 1) * half, half, 1)
        least = max(modulus(known.below.value) - known.below.spread, floor)
        fastest = (2 * part + 2) * half  # |ŝ| ≤ ω
        sizes = [
            modulus(one.value) + one.spread
            for one in (known.speed_of_force, known.place_of_force, known.speed_of_place,
                        known.place_of_place)
        ]  # fmt: skip
        sizes[2] *= fastest
        found = np.maximum(found, np.array(sizes) / least)
    speed, place, speed_x, place_x = (float(one) for one in found)
    return speed, place, speed_x, place_x


@lru_cache(maxsize=512)
def _responses_beside(
    path: MeasurementPath, slow: float, count: int, omega: float
) -> tuple[tuple[float, ...], ...]:
    """Return sums over aliases beyond ``count`` that are no folds.

    Of the force's responses over |ω_k| and |ω_k|² below the first fold, over |ω_k|² beyond it, and
    of the place's over |ω_k|³.
    """
    ticks = round(2 * math.pi / slow / path.sample_time)
    bounds, sums = _bounds(path, slow, omega), np.zeros((4, 2))
    for k, away in _aliases(count, ticks):
        at, (force, place) = k * slow - omega, (bounds[away - 1, :2], bounds[away - 1, 2:])
        if k < ticks:
            sums[0] += 2 * force / at
            sums[1] += 2 * force / at**2
        else:
            sums[2] += 2 * force / at**2
        sums[3] += 2 * place / at**3
    last, most = (_PERIODS * ticks - 1.5) * slow, np.max(bounds, axis=0)
    sums[2] += 2 * most[:2] / (slow * last)
    sums[3] += most[2:] / (slow * last**2)
    return tuple(tuple(float(one) for one in row) for row in sums)


def _sums(path: MeasurementPath, slow: float, count: int, omega: float) -> FloatArray:
    return np.array(_responses_beside(path, slow, count, omega))


def _aliases(count: int, ticks: int) -> list[tuple[int, int]]:
    """Return k beyond ``count`` that are no folds, each with its distance from the nearest fold."""
    found = [(k, abs(k - ticks * round(k / ticks))) for k in range(count + 1, _PERIODS * ticks)]
    return [(k, away) for k, away in found if away > 0]


def _bounds(path: MeasurementPath, slow: float, omega: float) -> FloatArray:
    """Return bounds of the four responses, a row per distance from the nearest fold."""
    ticks = round(2 * math.pi / slow / path.sample_time)
    rows = [_away(path, away * slow, omega) for away in range(1, ticks // 2 + 1)]
    return np.array(rows or [np.zeros(4)])


def _away(path: MeasurementPath, distance: float, omega: float) -> FloatArray:
    """Return bounds of the responses within ω of so far from a multiple of the fast rate."""
    time = path.sample_time
    first, second, third = path.l_1 / time, path.l_2 / time, path.l_3 / time
    near = 2 / time * math.sin(min(0.5 * (distance - omega) * time, math.pi / 2))
    rest = near - slowest_error(path)[0]
    below = max(rest**3 if rest > 0 else 0.0, floor_of(path))
    size = min(distance + omega, 2 / time)  # |ŝ|
    heard = [
        size * (size + first + 0.5 * time * second),
        size,
        size * (second * size + third),
        first * size * size + second * size + third,
    ]
    return np.array(heard) / below
