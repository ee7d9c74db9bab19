"""The noise gain: rms of F_ref per metre rms of position noise.

Noise is white at T_S,fast and passes the position filter, then K_P,vel (G_P + Eq. 23) with the loop
not closed. G_P is Eq. 22 as it stands but for its integral term, whose output has no finite rms
without the loop that it belongs to. The controller as the target runs it, under Tustin at T_S,
passes less where τ is short; the median, taken as one sample, changes nothing.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from mptune.signals.conditioning import filter_response
from mptune.signals.differentiator import differentiator_over_s

if TYPE_CHECKING:
    from mptune.arrays import ComplexArray, FloatArray
    from mptune.params.packed import LoopGains, MeasurementPath

_POINTS = 2000  # of the integral over frequency; its relative error is below 1e-5
_LOWEST = 1e-5  # of half the sampling rate


def noise_gram(tau: float, path: MeasurementPath) -> FloatArray:
    """Return ``(4, 4)`` G, with which the noise gain is K_P,vel √(cᵀ G c).

    c = (1, K_P, 2ξK_P/ω, K_P/ω²) are the factors of Eq. 23 and of the three terms of Eq. 22's
    first numerator, all over (τs + 1)².
    """
    s, through, velocity, weight = _fixed_parts(path)
    shape = through / (tau * s + 1) ** 2  # Eq. 22, first denominator
    parts = np.stack([velocity, shape, s * shape, s * s * shape])
    return np.asarray(((parts * weight) @ parts.conj().T).real)


@lru_cache(maxsize=16)
def _fixed_parts(
    path: MeasurementPath,
) -> tuple[ComplexArray, ComplexArray, ComplexArray, FloatArray]:
    """Return s, the filter, Eq. 23 through it, and the weights of the integral, ``(F,)`` each."""
    half_rate = np.pi / path.sample_time
    omega = np.geomspace(_LOWEST * half_rate, half_rate, _POINTS)
    s = np.asarray(1j * omega, np.complex128)
    through = filter_response(s, path.sample_time, path.filter_pole)
    velocity = through * s * differentiator_over_s(s, path.sample_time)  # Eq. 23
    steps = np.diff(omega, prepend=omega[0], append=omega[-1])
    weight = 0.5 * (steps[1:] + steps[:-1]) / half_rate  # the trapezoidal rule's
    return s, through, velocity, weight


def noise_gain(gains: LoopGains, path: MeasurementPath) -> float:
    """Return rms of F_ref per rms of white position noise at T_S,fast [N/m]."""
    k_p, omega = gains.k_p_pos, gains.omega
    factors = np.array([1.0, k_p, 2 * gains.xi * k_p / omega, k_p / omega**2])
    square = factors @ noise_gram(gains.tau, path) @ factors
    return float(gains.k_p_vel * np.sqrt(square))
