"""The frequencies of a sweep: chosen from the study, refined where the worst may hide."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.params.packed import LoopGains, NominalPlant, Plants

FREQUENCIES = 400  # of the first grid
_TAIL_RATIO = 0.05  # above the grid no left/right ratio can exceed this
_SLOWEST = 1e-9  # of the crossover: below it a sampled loop cannot be told from 1 in double
_OCTAVES = 60  # at most, that the tail of Eq. 21 is followed


def frequency_range(plants: Plants, nominal: NominalPlant, gains: LoopGains) -> tuple[float, float]:
    """Return the lowest and highest frequency of the first grid [rad/s].

    The lowest stands a factor of 50 below the slowest corner of loop and controller that matters:
    one a thousand million times slower than the crossover tells nothing from none at all. Above the
    highest, Eq. 17's ratio is certainly small: |Δ_vel| ≤ 1 + m_min/m as |G_F| ≤ 1, and
    |L/(1 + L)| ≤ |L|/(1 − |L|) with |L| ≤ K_P,vel/(m_min ω). So is Eq. 21's, see below.
    """
    crossover = gains.k_p_vel / nominal.mass
    slowest = [gains.k_p_vel / float(plants.mass.max()), gains.omega, 1 / gains.tau]
    if gains.k_p_pos > 0:
        slowest.append(gains.k_p_pos)
        slowest.append(gains.k_i_pos / gains.k_p_pos or gains.k_p_pos)
    lowest = max(min(slowest) / 50, _SLOWEST * crossover)
    error = 1 + nominal.mass / float(plants.mass.min())
    highest = max(crossover * (1 + error / _TAIL_RATIO), 10 / gains.tau)
    for _ in range(_OCTAVES):
        if _position_tail(highest, crossover, error, gains) <= _TAIL_RATIO:
            break
        highest *= 2
    return lowest, highest


def _position_tail(omega: float, crossover: float, error: float, gains: LoopGains) -> float:
    """Return a bound of Eq. 21's ratio at ω [rad/s] and beyond; infinite where there is none.

    With |L_v| ≤ crossover/ω and |G_P| ≤ C, the nominal loop is at most q = C/(ω (ω/crossover − 1))
    and Δ_pos at most the velocity error over 1 − μ crossover/ω.
    """
    corner, damping = gains.omega, 2 * gains.xi / gains.omega
    shape = (1 / corner**2 + damping / omega + 1 / omega**2) / gains.tau**2
    controller = gains.k_p_pos * shape + gains.k_i_pos / omega
    if omega <= 2 * crossover * max(error - 1, 1.0):
        return np.inf
    loop = controller / (omega * (omega / crossover - 1))
    if loop >= 1:
        return np.inf
    return error / (1 - (error - 1) * crossover / omega) * loop / (1 - loop)


def first_grid(low: float, high: float) -> FloatArray:
    """Return the first, logarithmic grid."""
    return np.geomspace(low, high, FREQUENCIES)


def refinement(omega: FloatArray, values: FloatArray, within: float = 0.2) -> FloatArray:
    """Return new frequencies on both sides of every peak that is nearly the highest.

    A level stretch counts as one peak, at its lower end.

    Parameters
    ----------
    omega
        ``(F,)`` frequencies, rising.
    values
        ``(F,)`` the curve whose maximum is wanted.
    within
        Peaks lower than the highest by more than this share are left alone.

    Returns
    -------
    FloatArray
        Three points within each of the two intervals beside each peak.
    """
    padded = np.concatenate([[-np.inf], values, [-np.inf]])
    peak = (values > padded[:-2]) & (values >= padded[2:])
    peak &= values >= (1 - within) * values.max()
    index = np.flatnonzero(peak)
    low = omega[np.maximum(index - 1, 0)]
    high = omega[np.minimum(index + 1, len(omega) - 1)]
    shares = np.array([0.25, 0.5, 0.75])
    left = low[:, None] + (omega[index] - low)[:, None] * shares
    right = omega[index][:, None] + (high - omega[index])[:, None] * shares
    return np.setdiff1d(np.concatenate([left.ravel(), right.ravel()]), omega)
