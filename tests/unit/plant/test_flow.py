"""The orifice: the signed root, smoothed at zero."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mptune.plant.flow import orifice, orifice_slope

TRANSITION = 1e5
differences = st.floats(-2e7, 2e7)


@given(differences)
def test_flow_is_odd_and_never_runs_from_low_to_high_pressure(difference):
    flow = orifice(difference, TRANSITION)
    assert flow == -orifice(-difference, TRANSITION)
    assert flow * difference >= 0


@given(differences, st.floats(1, 1e6))
def test_flow_rises_with_the_difference(difference, more):
    assert orifice(difference + more, TRANSITION) > orifice(difference, TRANSITION)


@given(st.floats(1e5, 2e7))
def test_above_the_transition_it_is_the_root(difference):
    assert orifice(difference, TRANSITION) == np.sqrt(difference)


@pytest.mark.parametrize("transition", [1e4, 1e5, 5e5])
def test_value_and_slope_are_continuous_at_the_transition(transition):
    below, above = transition * (1 - 1e-12), transition
    for function in (orifice, orifice_slope):
        inside, outside = function(below, transition), function(above, transition)
        assert inside == pytest.approx(outside, rel=1e-9)


@given(differences)
def test_slope_is_the_difference_quotient(difference):
    width = max(1e-4 * abs(difference), 1.0)
    high, low = (orifice(difference + sign * width, TRANSITION) for sign in (1, -1))
    quotient = (high - low) / (2 * width)
    assert orifice_slope(difference, TRANSITION) == pytest.approx(quotient, rel=2e-4)


def test_one_valve_passes_10_litres_a_minute_at_half_a_megapascal(boom):
    valves = boom.study.valves
    flow = 6e4 * valves.flow_coefficient * orifice(0.5e6, valves.transition_pressure)
    print(f"{flow:.3f} l/min")
    assert flow == pytest.approx(10, rel=1e-3)
