"""Complex balls with a derivative against mpmath: rounding at the centre, reach over the interval.

Derivatives are mpmath's own, by differences in 60 digits.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp

from mptune.certify import balls
from mptune.certify.balls import Dual

mp.dps = 60
OMEGAS = st.floats(-3000.0, 3000.0)
HALVES = st.one_of(st.just(0.0), st.floats(1e-9, 50.0))
TIMES = st.floats(1e-5, 0.05)
SHARES = (-1.0, -0.61, 0.0, 0.37, 1.0)


def assert_encloses(dual, function, omega, half):
    exact = function(mp.mpf(omega))
    assert abs(mp.mpc(dual.value) - exact) <= dual.error
    assert dual.error <= dual.spread
    for share in SHARES:
        at = mp.mpf(omega) + mp.mpf(share) * mp.mpf(half)
        assert abs(mp.mpc(dual.value) - function(at)) <= dual.spread
        slope = mp.diff(function, at)
        assert abs(mp.mpc(dual.slope) - slope) <= dual.slope_spread * (1 + 1e-12) + 1e-25


def turn(time):
    return lambda omega: mp.expj(-omega * mp.mpf(time))


def sinc(time):
    return lambda omega: mp.sinc(omega * mp.mpf(time))


def line(c0, c1):
    return lambda omega: mp.mpf(c0) + 1j * mp.mpf(c1) * omega


@given(OMEGAS, HALVES, TIMES)
def test_a_turning_number(omega, half, time):
    assert_encloses(balls.turning(omega, half, time), turn(time), omega, half)


@given(OMEGAS, HALVES, TIMES)
def test_a_sinc(omega, half, time):
    assert_encloses(balls.sinc(omega, half, time), sinc(time), omega, half)


@pytest.mark.parametrize("x", [0.0, 1e-9, 0.1, 0.2499999, 0.25, 0.2500001, 0.5])
def test_a_sinc_where_its_series_takes_over(x):
    assert_encloses(balls.sinc(x, 0.01, 1.0), sinc(1.0), x, 0.01)


@given(OMEGAS, HALVES, st.lists(st.floats(0.0, 2.0), min_size=6, max_size=6))
def test_a_polynomial(omega, half, coefficients):
    def exact(at):
        return sum(mp.mpf(c) * (1j * at) ** i for i, c in enumerate(coefficients))

    assert_encloses(balls.polynomial(omega, half, *coefficients), exact, omega, half)


@given(OMEGAS, HALVES, TIMES, st.floats(-5.0, 5.0), st.floats(0.01, 3.0))
def test_sums_products_and_multiples(omega, half, time, factor, slope):
    a = balls.turning(omega, half, time)
    b = balls.polynomial(omega, half, 1.0, slope, 0.0, 0.0, 0.0, 0.0)
    exact_a, exact_b = turn(time), line(1.0, slope)
    assert_encloses(balls.plus(a, b), lambda at: exact_a(at) + exact_b(at), omega, half)
    assert_encloses(balls.times(a, b), lambda at: exact_a(at) * exact_b(at), omega, half)
    assert_encloses(balls.scaled(b, factor), lambda at: mp.mpf(factor) * exact_b(at), omega, half)
    assert_encloses(balls.conjugate(b), lambda at: mp.conj(exact_b(at)), omega, half)
    product = balls.times(a, b)
    assert_encloses(
        balls.squared_modulus(product), lambda at: 1 + (mp.mpf(slope) * at) ** 2, omega, half
    )


@given(OMEGAS, HALVES, TIMES, st.floats(0.0, 0.99))
def test_an_inverse(omega, half, time, pole):
    one = balls.plus(balls.constant(1.0), balls.scaled(balls.turning(omega, half, time), -pole))
    exact = turn(time)
    assert_encloses(
        balls.inverse(one, (1 - pole) * (1 - 1e-12)),
        lambda at: 1 / (1 - mp.mpf(pole) * exact(at)),
        omega,
        half,
    )


def test_rounding_is_counted_even_where_nothing_moves():
    a = balls.turning(55.0, 0.0, 0.0215)
    assert 0 < a.error <= a.spread < 1e-14
    product = a
    for _ in range(50):
        product = balls.times(product, a)
    assert 30 * a.error < product.error < 1e-12


def test_a_ball_that_is_too_small_is_found_out():
    good = balls.turning(100.0, 1.0, 0.02)
    bad = Dual(good.value, good.error, 0.5 * good.spread, good.slope, good.slope_spread)
    with pytest.raises(AssertionError):
        assert_encloses(bad, turn(0.02), 100.0, 1.0)


def test_the_modulus_is_that_of_numpy():
    z = np.array([3 + 4j, -1e-30j, 0j])
    assert [balls.modulus(one) for one in z] == pytest.approx(np.abs(z))
