"""Eq. 4: the effective bulk modulus of a chamber with its hose."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.plant.bulk import effective_bulk_modulus


def test_a_chamber_that_is_all_hose_is_both_springs_in_series():
    assert effective_bulk_modulus(8e8, 6e8, 1e-4, 1e-4) == pytest.approx(
        8e8 * 6e8 / (8e8 + 6e8), rel=1e-12
    )


def test_without_a_hose_the_oil_alone_remains():
    assert effective_bulk_modulus(1.4e9, 6e8, 0.0, 1e-3) == pytest.approx(1.4e9, rel=1e-15)


def test_the_a_side_of_table_1_at_mid_stroke_by_hand():
    hose = np.pi / 4 * 0.019**2 * 0.8  # 0.2268 dm³
    volume = 0.00502655 * 0.15 + 0.4e-3 + hose  # 1.3808 dm³
    found = effective_bulk_modulus(8e8, 6e8, hose, volume)
    print(f"B_eff,A at mid-stroke: {found / 1e6:.1f} MPa")
    assert found == pytest.approx(656.3e6, rel=1e-4)


def test_more_volume_makes_the_chamber_stiffer_towards_the_oil_s_own_modulus():
    volume = np.linspace(2e-4, 2e-3, 50)
    moduli = effective_bulk_modulus(8e8, 6e8, 2e-4, volume)
    assert np.all(np.diff(moduli) > 0)
    assert np.all(moduli < 8e8)
