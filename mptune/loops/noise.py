"""The noise gain: rms of F_ref per metre rms of position noise.

Noise enters white at T_S,fast, passes median (as one sample), filter and Eq. 23, is read at T_S and
goes through K_P,vel (G_P + 1) as the target runs it, the loop not closed. The integral term is left
out: without the loop that it belongs to, its output has no finite rms. That errs on the low side.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import FloatArray, kernel
from mptune.signals.differentiator import TAPS

if TYPE_CHECKING:
    from mptune.params.pack import LoopGains, MeasurementPath

_FADED = 1e-10  # of a sample's first effect: later ones are left out


@kernel
def noise_gram(tau: float, path: MeasurementPath, period: float) -> FloatArray:
    """Return ``(4, 4)`` G, with which the noise gain is K_P,vel √(cᵀ G c).

    c = (1, K_P, 2ξK_P/ω, K_P/ω²): the velocity, and the three terms of Eq. 22's numerator, all over
    (τs + 1)² under Tustin at ``period`` [s].
    """
    ticks = round(period / path.sample_time)
    pole = path.filter_pole
    rate = 2 / period
    lag = tau * rate
    lead = (lag + 1) ** 2
    a1, a2 = 2 * (1 - lag * lag) / lead, (1 - lag) ** 2 / lead
    b = np.array([[1.0, 2.0, 1.0], [rate, 0.0, -rate], [rate**2, -2 * rate**2, rate**2]]) / lead
    slowest = max(pole**ticks, abs(lag - 1) / (lag + 1))
    periods = int(np.ceil(np.log(_FADED) / np.log(min(max(slowest, 0.1), 0.999)))) + 2
    gram = np.zeros((4, 4))
    row = np.empty(4)
    for phase in range(1, ticks + 1):  # ticks from a noise sample to the next decision
        first, second = np.zeros(3), np.zeros(3)  # states of the sections
        for k in range(periods):
            age = phase + k * ticks
            read = _weight(age, pole)
            row[0] = 0.0
            for tap in range(len(TAPS)):
                row[0] += TAPS[tap] * _weight(age - tap, pole) / path.sample_time  # Eq. 23
            for i in range(3):
                out = b[i, 0] * read + first[i]
                first[i] = b[i, 1] * read - a1 * out + second[i]
                second[i] = b[i, 2] * read - a2 * out
                row[1 + i] = out
            gram += np.outer(row, row)
    return gram


@kernel
def _weight(age: int, pole: float) -> float:
    """Return the filter's weight of a sample; the median keeps the newest one out."""
    return (1 - pole) * pole ** (age - 1) if age >= 1 else 0.0


@kernel
def noise_gain(gains: LoopGains, path: MeasurementPath, period: float) -> float:
    """Return rms of F_ref per rms of white position noise at T_S,fast [N/m]."""
    gram = noise_gram(gains.tau, path, period)
    terms = np.array(
        [
            1.0,
            gains.k_p_pos,
            2 * gains.xi * gains.k_p_pos / gains.omega,
            gains.k_p_pos / gains.omega**2,
        ]
    )
    return float(gains.k_p_vel * np.sqrt(np.dot(terms, np.dot(gram, terms))))
