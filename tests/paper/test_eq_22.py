"""Eq. 22: the five-parameter position controller."""

from __future__ import annotations

import pytest

from mptune.loops.position import position_controller


def test_a_proportional_term_alone_is_flat_where_lead_and_lag_cancel():
    # ω = 1/τ and ξ = 1: the numerator is (τs + 1)²
    assert position_controller(3 + 40j, 13.0, 0.0, 100.0, 1.0, 0.01) == pytest.approx(13, rel=1e-14)


def test_an_integral_term_alone_is_an_integrator():
    assert position_controller(2j, 0.0, 22.0, 42.0, 0.55, 0.006) == pytest.approx(-11j, rel=1e-15)


def test_at_low_frequency_it_is_pi():
    s = 1e-4j
    found = position_controller(s, 13.0, 22.0, 42.0, 0.55, 0.006)
    assert found == pytest.approx(13 + 22 / s, rel=1e-8)


def test_at_omega_the_damping_alone_remains():
    s = 42j
    found = position_controller(s, 13.0, 0.0, 42.0, 0.55, 0.006)
    assert found == pytest.approx(13 * 2j * 0.55 / (1 + 0.006 * s) ** 2, rel=1e-13)


def test_at_high_frequency_the_gain_is_k_p_over_the_squared_product_of_omega_and_tau():
    found = position_controller(1e9j, 13.0, 22.0, 42.0, 0.55, 0.006)
    print(f"published G_P at high frequency: {found.real:.1f} 1/s")
    assert found == pytest.approx(13 / (42 * 0.006) ** 2, rel=1e-6)
