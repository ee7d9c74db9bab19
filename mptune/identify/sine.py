"""One sine at a time: whole periods in whole sampling periods, fitted by least squares (§2.4)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from mptune.arrays import ComplexArray, FloatArray

_SHORTEST = 2.0  # s of record at the least


def whole_periods(omega: float, sampling_period: float) -> tuple[float, int]:
    """Return a frequency near ``omega`` [rad/s] and a record's length in sampling periods.

    The record holds a whole number of periods, so that no part of one biases the fit, and that
    number has no divisor in common with the sampling periods: no phase is sampled twice. The
    frequency moves by half a sampling period in the record's two seconds at the most.
    """
    periods = max(1, math.ceil(_SHORTEST * omega / (2 * math.pi)))
    while True:
        length = round(2 * math.pi * periods / (omega * sampling_period))
        if math.gcd(periods, length) == 1:
            return 2 * math.pi * periods / (length * sampling_period), length
        periods += 1


def fit_sine(
    u: FloatArray, y: FloatArray, sample_time: float, omega: float
) -> tuple[ComplexArray, FloatArray]:
    """Fit sine, cosine and offset to an input and to outputs by least squares.

    Parameters
    ----------
    u
        ``(T,)`` input.
    y
        ``(N, T)`` outputs to that input.
    sample_time
        Time between samples [s].
    omega
        Frequency [rad/s].

    Returns
    -------
    response
        ``(N,)`` fitted output over fitted input.
    quality
        ``(N,)`` 1 − (rms of the residual over rms of the fitted sine)²; negative where the
        residual is the larger.
    """
    phase = omega * sample_time * np.arange(len(u))
    basis = np.stack([np.sin(phase), np.cos(phase), np.ones(len(u))])
    signals = np.vstack([u, y])
    # The normal equations: over whole periods their matrix is diagonal.
    found = np.linalg.solve(basis @ basis.T, basis @ signals.T)
    residual = np.mean((signals - found.T @ basis) ** 2, axis=1)[1:]
    phasor = found[0] + 1j * found[1]
    power = 0.5 * np.abs(phasor[1:]) ** 2
    share = np.full(len(y), np.inf)
    np.divide(residual, power, out=share, where=power > 0)
    return phasor[1:] / phasor[0], 1 - share
