"""Quantities over all units that study files use, and over texts that are none."""

from __future__ import annotations

import contextlib
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mptune.units import DISPLAY, UnitError, parse_quantity, shown

UNITS = {
    "MPa": ("Pa", 1e6),
    "bar": ("Pa", 1e5),
    "mm": ("m", 1e-3),
    "dm^3": ("m^3", 1e-3),
    "cm^2": ("m^2", 1e-4),
    "ms": ("s", 1e-3),
    "t": ("kg", 1e3),
    "kN": ("N", 1e3),
    "kN s/m": ("N s/m", 1e3),
    "l/min": ("m^3/s", 1e-3 / 60),
    "mm/s": ("m/s", 1e-3),
    "rad/s": ("rad/s", 1.0),
    "deg/s": ("rad/s", math.pi / 180),
    "1/min": ("1/s", 1 / 60),
    "1/s^2": ("1/s^2", 1.0),
    "N/J": ("N/J", 1.0),
    "N s/m^6": ("N s/m^6", 1.0),
    "m^3/(s Pa^0.5)": ("m^3/(s Pa^0.5)", 1.0),
}
numbers = st.floats(min_value=-1e12, max_value=1e12)


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_an_si_value_comes_back_to_the_last_bit(number):
    assert parse_quantity(f"{number!r} Pa", "Pa") == number


@given(numbers, st.sampled_from(sorted(UNITS)))
def test_a_unit_is_its_factor(number, unit):
    si, factor = UNITS[unit]
    assert parse_quantity(f"{number!r} {unit}", si) == pytest.approx(
        number * factor, rel=1e-14, abs=1e-300
    )


@given(numbers, st.sampled_from(sorted(UNITS)), st.sampled_from(["", " ", "   ", "\t"]))
def test_the_space_before_the_unit_does_not_matter(number, unit, space):
    si, _ = UNITS[unit]
    if unit[0].isdigit() and not space:
        return  # "131/min" is another number
    written = parse_quantity(f"{number!r}{space}{unit}", si)
    assert written == parse_quantity(f"{number!r} {unit}", si)


@given(numbers, st.sampled_from(sorted(UNITS)), st.sampled_from(sorted(UNITS)))
def test_a_unit_of_another_dimension_is_refused(number, unit, other):
    si, _ = UNITS[other]
    if UNITS[unit][0] == si or {UNITS[unit][0], si} == {"rad/s", "1/s"}:
        return
    with pytest.raises(UnitError, match="wrong dimension"):
        parse_quantity(f"{number!r} {unit}", si)


# No powers of powers here: those are refused by a test of their own, within a time limit.
texts = st.text(st.sampled_from("0123456789.eE+- /*()mMkPasN_µ²\t\x00;'\"")) | st.text()


@given(texts)
def test_any_text_is_a_finite_quantity_or_refused(text):
    with contextlib.suppress(UnitError):
        assert math.isfinite(parse_quantity(text, "Pa"))


PRINTED = sorted({unit for unit, _ in UNITS.values()} | set(DISPLAY) - {"1"})


@given(st.floats(min_value=-1e9, max_value=1e9), st.sampled_from(PRINTED))
def test_what_is_printed_is_read_back(value, unit):
    """To the digits that are printed, four of them, in the unit that people read it in."""
    value += 0.0  # no −0
    read = parse_quantity(shown(value, unit), unit)
    assert read == pytest.approx(value, rel=5.01e-4, abs=1e-300)
    assert shown(read, unit) == shown(value, unit)
