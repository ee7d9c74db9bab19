"""What noise makes of F_ref: its gain from position noise, and its rms from all sensors.

Noise is white at T_S,fast and passes the position filter, then K_P,vel (G_P + Eq. 23) with the loop
not closed. G_P is Eq. 22 as it stands but for its integral term, whose output has no finite rms
without the loop that it belongs to. The controller as the target runs it, under Tustin at T_S,
passes less where τ is short; the median, taken as one sample, changes nothing. A state estimator
hears both pressures as well, of which the filters' loops know nothing: the rms of F_ref in newtons
is one formula for both. The median takes off some of white noise, so that all figures err on the
high side.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import frozen
from mptune.signals.conditioning import filter_response
from mptune.signals.differentiator import differentiator_over_s
from mptune.signals.estimator import heard_along

if TYPE_CHECKING:
    from mptune.arrays import ComplexArray, FloatArray
    from mptune.params.packed import LoopGains, MeasurementPath

_POINTS = 2000  # of the integral over frequency; its relative error is below 1e-5
_LOWEST = 1e-5  # of half the sampling rate


def noise_gram(tau: float, path: MeasurementPath) -> FloatArray:
    """Return ``(4, 4)`` G of position noise, with which its gain is K_P,vel √(cᵀ G c).

    c = (1, K_P, 2ξK_P/ω, K_P/ω²) are the factors of Eq. 23 and of the three terms of Eq. 22's
    first numerator, all over (τs + 1)².
    """
    return _gram(tau, path, of_force=False)


def pressure_gram(tau: float, path: MeasurementPath) -> FloatArray:
    """Return the same of noise of the force that both pressures make [N]; zero with filters."""
    if path.estimator_mass == 0:
        return np.zeros((4, 4))
    return _gram(tau, path, of_force=True)


@lru_cache(maxsize=64)  # a search's gradient turns other gains than τ most of the time
def _gram(tau: float, path: MeasurementPath, *, of_force: bool) -> FloatArray:
    s, place, speed, weight = _fixed_parts(path, of_force=of_force)
    shape = place / (tau * s + 1) ** 2  # Eq. 22, first denominator
    parts = np.stack([speed, shape, s * shape, s * s * shape])
    return frozen(((parts * weight) @ parts.conj().T).real)


@lru_cache(maxsize=16)
def _fixed_parts(
    path: MeasurementPath, *, of_force: bool
) -> tuple[ComplexArray, ComplexArray, ComplexArray, FloatArray]:
    """Return s, place and velocity as heard, and the weights of the integral, ``(F,)`` each."""
    half_rate = np.pi / path.sample_time
    omega = np.geomspace(_LOWEST * half_rate, half_rate, _POINTS)
    s = np.asarray(1j * omega, np.complex128)
    place, speed = _heard(s, path, of_force=of_force)
    steps = np.diff(omega, prepend=omega[0], append=omega[-1])
    weight = 0.5 * (steps[1:] + steps[:-1]) / half_rate  # the trapezoidal rule's
    return s, place, speed, weight


def _heard(
    s: ComplexArray, path: MeasurementPath, *, of_force: bool
) -> tuple[ComplexArray, ComplexArray]:
    """Return position and velocity that the controller hears per noise of position or force."""
    if path.estimator_mass == 0:
        place = filter_response(s, path.sample_time, path.filter_pole)
        return place, place * s * differentiator_over_s(s, path.sample_time)  # Eq. 23
    known = heard_along(s, path)
    place, speed = known[2:] if of_force else known[:2]
    return place, speed


def noise_gain(gains: LoopGains, path: MeasurementPath) -> float:
    """Return rms of F_ref per rms of white position noise at T_S,fast [N/m]."""
    return _gain(gains, noise_gram(gains.tau, path))


def noise_force(
    gains: LoopGains, path: MeasurementPath, position_noise: float, force_noise: float
) -> float:
    """Return the rms of F_ref that all sensors' noise makes [N].

    Parameters
    ----------
    gains, path
        The gains, and the filters or the state estimator.
    position_noise
        rms of the position's noise [m].
    force_noise
        rms of the noise of A_A p_A − A_B p_B [N].
    """
    of_force = _gain(gains, pressure_gram(gains.tau, path))
    return math.hypot(noise_gain(gains, path) * position_noise, of_force * force_noise)


def _gain(gains: LoopGains, gram: FloatArray) -> float:
    k_p, omega = gains.k_p_pos, gains.omega
    factors = np.array([1.0, k_p, 2 * gains.xi * k_p / omega, k_p / omega**2])
    return float(gains.k_p_vel * np.sqrt(factors @ gram @ factors))
