"""The force loop as the outer loops see it (§2.4)."""

from __future__ import annotations

import numpy as np

from mptune.arrays import Complex, FloatArray, Real, kernel


@kernel
def force_dynamics(s: Complex, tau_a: float, tau_b: float, share_a: float) -> Complex:
    """Return G_F(s), from force reference to force.

    Parameters
    ----------
    s
        Complex frequency [rad/s].
    tau_a, tau_b
        Time constants of the chamber pressures [s].
    share_a
        A_A/(A_A + A_B).

    Notes
    -----
    The numerator's time constant is an average of τ_A and τ_B, so that |G_F| ≤ 1 wherever
    Re s ≥ 0. The denominators follow the ledger of disagreements (``mptune.params.paper``).
    """
    lead = tau_b * share_a + tau_a * (1 - share_a)
    return (lead * s + 1) / ((tau_a * s + 1) * (tau_b * s + 1))  # Eq. 11


def pressure_time_constant(
    bulk_modulus: Real, estimate: Real, sampling_period: float
) -> FloatArray:
    """Return the time constant of a chamber pressure [s].

    Parameters
    ----------
    bulk_modulus, estimate
        B_eff and its estimate B̂_eff [Pa], 0 < B ≤ B̂.
    sampling_period
        T_S [s].

    Raises
    ------
    ValueError
        If a bulk modulus is not positive or above its estimate.
    """
    ratio = np.asarray(bulk_modulus, dtype=np.float64) / estimate
    if not np.all((ratio > 0) & (ratio <= 1)):
        raise ValueError("Eq. 12 needs 0 < B_eff ≤ B̂_eff; raise the estimate of the bulk modulus")
    with np.errstate(divide="ignore"):
        return np.asarray(-sampling_period / np.log1p(-ratio))  # Eq. 12; 0 where B = B̂
