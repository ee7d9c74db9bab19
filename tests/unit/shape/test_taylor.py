"""Enclosures over intervals against 40 digits."""

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mptune.shape.taylor import constant, delayed, factors, plus, polynomial, times

mpmath.mp.dps = 40
PLACES = (-1.0, -0.7, 0.0, 0.3, 1.0)

roots = st.lists(st.builds(complex, st.floats(-30, 30), st.floats(-30, 30)), min_size=1, max_size=4)
centres = st.floats(1e-3, 1e3)
widths = st.floats(1e-9, 1.0)


def encloses(line, exponent, exact, omega, radius):
    """Whether f over the whole interval lies where the line says, by 40 digits."""
    scale = mpmath.mpf(2) ** int(exponent)
    for place in PLACES:
        value = exact(mpmath.mpf(omega) + mpmath.mpf(place) * radius)
        told = (
            mpmath.mpc(complex(line.value[0])) + mpmath.mpc(complex(line.move[0])) * place
        ) * scale
        if abs(value - told) > mpmath.mpf(float(line.rest[0])) * scale:
            return False
    return True


@given(
    roots=roots,
    coefficients=st.lists(st.floats(-9, 9), min_size=1, max_size=4),
    time=st.floats(0, 5),
    omega=centres,
    width=widths,
)
def test_products_and_sums_enclose(roots, coefficients, time, omega, width):
    radius = width * omega
    w, r = np.array([omega]), np.array([radius])
    product, power = factors(-np.array([roots]), w, r)
    other, power_other = polynomial(coefficients, w, r)
    turn = delayed(np.array([time]), w, r)
    total = plus(times(times(product, other), turn), constant(np.array([2.0])))
    shift = int(power[0] + power_other[0])

    def exact(omega):
        s = mpmath.mpc(0, omega)
        found = sum(c * s**k for k, c in enumerate(reversed(coefficients))) * mpmath.exp(
            -s * mpmath.mpf(time)
        )
        for root in roots:
            found *= s - mpmath.mpc(root)
        return found + mpmath.mpf(2) * mpmath.mpf(2) ** shift

    assert encloses(total, shift, exact, omega, radius)


def test_a_light_mode_loses_no_digit():
    """Next to a pole the enclosure is relative to the distance, not to the frequency."""
    pole = complex(-3e-12, 3.0)
    line, power = factors(np.array([[-pole]]), np.array([3.0]), np.array([0.0]))
    assert line.value[0] * 2.0 ** power[0] == pytest.approx(3e-12, rel=1e-14)
    assert line.rest[0] <= 1e-14 * abs(line.value[0])


def test_no_factor_stands_for_one():
    line, power = factors(np.array([[np.nan + 0j]]), np.array([5.0]), np.array([0.1]))
    assert line.value[0] * 2.0 ** power[0] == 1
    assert line.move[0] == 0


def test_lines_bound_the_size():
    radius = np.array([0.25])
    line, power = factors(np.array([[1.0 + 0j]]), np.array([2.0]), radius)
    scale = 2.0 ** power[0]
    assert line.smallest[0] * scale <= abs(1 + 1.75j)
    assert line.largest[0] * scale >= abs(1 + 2.25j)
