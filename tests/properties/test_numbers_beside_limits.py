"""A number beside its limit is printed with as many digits as it needs to differ from it."""

import math

from hypothesis import given
from hypothesis import strategies as st

from mptune.robust.result import Check, Status
from mptune.units import exact, number, number_beside

LIMITS = st.floats(1e-3, 1e6)
STEPS = st.one_of(st.integers(1, 9), st.integers(1, 2**40))


@given(LIMITS, STEPS, st.booleans())
def test_what_differs_is_printed_differently(limit, steps, above):
    found = limit + (1 if above else -1) * steps * math.ulp(limit)
    text = number_beside(found, f"≤ {exact(limit)}")
    assert text != exact(limit)
    if "·" not in text:
        assert (float(text) > limit) == above
        assert float(text) != limit


@given(LIMITS)
def test_limits_are_printed_as_they_were_written(limit):
    assert float(exact(limit)) == limit
    assert number_beside(limit, f"≤ {exact(limit)}") == number(limit)


@given(LIMITS, st.floats(1.01, 100.0))
def test_four_digits_do_where_they_suffice(limit, factor):
    found = float(f"{factor * limit:.6g}")
    if f"{found:.4g}" != f"{limit:.4g}":
        assert number_beside(found, f"≤ {exact(limit)}") == number(found)


def test_what_was_said_once():
    check = Check("a", "a", "≤ 0.48", 0.480000004, Status.VIOLATED, None)
    assert check.headline == "a ≤ 0.48: 0.480000004, violated"
    both = Check("b", "b", "2 … 5 1/s", 5.00000001, Status.VIOLATED, None)
    assert both.found_text == "5.00000001"
    assert number_beside(math.nan, "≤ 0.48") == "—"
    assert number_beside(math.inf, "≤ 0.48") == "∞"
    assert exact(7e5) == "700000"
