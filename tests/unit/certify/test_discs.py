"""Discs over a box of plants: lags and turns hold every plant of it."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mptune.certify import discs
from mptune.certify.discs import Disc

SHARES = st.tuples(*(st.floats(-1.0, 1.0) for _ in range(2)))
ANGLES = st.floats(-40.0, 40.0)


@given(
    st.floats(-700.0, 700.0),
    st.floats(0.0, 0.03),
    st.floats(0.0, 60.0),
    st.floats(0.0, 1.0),
    SHARES,
)
def test_a_lag_holds_all_frequencies_and_time_constants(omega, tau, half, share, shares):
    half_tau = share * tau
    found = discs.lag(omega, tau, half, half_tau)
    other = 1 / (1 + 1j * (omega + shares[0] * half) * (tau + shares[1] * half_tau))
    assert abs(other - found.value) <= found.spread
    assert abs(1 / (1 + 1j * omega * tau) - found.value) <= found.error


@given(ANGLES, st.floats(0.0, 4.0), st.floats(-1.0, 1.0))
def test_a_turn_holds_all_angles(phase, reach, share):
    found = discs.turning_disc(phase, reach)
    assert abs(np.exp(-1j * (phase + share * reach)) - found.value) <= found.spread


@given(ANGLES, ANGLES, st.floats(0.0, 2.0), st.floats(0.0, 2.0), ANGLES, ANGLES)
def test_operations_hold_all_members_of_their_operands(x, y, spread_x, spread_y, angle_x, angle_y):
    a = Disc(np.exp(1j * x) * 3, 1e-16, spread_x + 1e-15)
    b = Disc(np.exp(1j * y), 1e-16, spread_y + 1e-15)
    of_a = a.value + spread_x * np.exp(1j * angle_x)
    of_b = b.value + spread_y * np.exp(1j * angle_y)
    for found, member in (
        (discs.product(a, b), of_a * of_b),
        (discs.total(a, b), of_a + of_b),
        (discs.lagging(a), -1j * of_a),
        (discs.multiple(a, 2.0, 0.5), 2.4 * of_a),
        (discs.multiple(a, -2.0, 0.5), -1.6 * of_a),
    ):
        assert abs(found.value - member) <= found.spread
    unit = np.exp(-1j * y)
    assert abs((of_a * unit).real) <= discs.along(a, unit) + 1e-12
    real, reach = discs.twice_real(a, 2.0, 0.5)
    assert abs(2 * 2.4 * of_a.real - real) <= reach
