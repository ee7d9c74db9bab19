"""Effective bulk modulus of a chamber with its hose (§2.1)."""

from __future__ import annotations

from mptune.arrays import Real, kernel


@kernel
def effective_bulk_modulus(oil: Real, hose: Real, hose_volume: Real, volume: Real) -> Real:
    """Return B_eff of a chamber.

    Parameters
    ----------
    oil
        B_oil, bulk modulus of the oil [Pa].
    hose
        B_h, bulk modulus of the hose [Pa].
    hose_volume
        V_h, volume of the hose [m³].
    volume
        Whole volume at the present piston position, A x + V_0 + V_h [m³].

    Returns
    -------
    number or array
        B_eff [Pa]; arrays in give arrays out.
    """
    return 1 / (1 / oil + hose_volume / volume * (1 / hose))  # Eq. 4
