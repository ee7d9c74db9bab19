"""A lag under a cubic input: exact against an ODE solver, and its short forms against it."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from mptune.params.packed import Plant
from mptune.sim.lag import (
    Cubic,
    fade_of,
    held_lag_end,
    hermite,
    integral,
    lag_end,
    lagged,
    value_and_slope,
)
from mptune.sim.linear_machine import move_on, push, stride_of

WANTED, STEP = Cubic(2.0, -30.0, 4e3, -5e5), 0.008


@pytest.mark.parametrize("tau", [0.0004, 0.006, 0.5])
def test_a_lag_and_its_integrals_equal_an_ode_solver_s(tau):
    def slope(t, y):
        return [(np.polyval(WANTED[::-1], t) - y[0]) / tau, y[0], y[1]]

    exact = solve_ivp(slope, (0, STEP), [5.0, 0, 0], "DOP853", rtol=1e-12, atol=1e-15).y[:, -1]
    found = lag_end(lagged(5.0, tau, WANTED), fade_of(tau, STEP), STEP)
    np.testing.assert_allclose(found, exact, rtol=1e-7)  # τ = 0.5 s cancels seven digits


def test_a_lag_of_no_time_passes_its_input_on():
    found = lag_end(lagged(5.0, 0.0, WANTED), fade_of(0.0, STEP), STEP)
    assert found[0] == pytest.approx(value_and_slope(WANTED, STEP)[0])
    assert found[1] == pytest.approx(integral(WANTED, STEP))


@pytest.mark.parametrize("tau", [0.0, 0.006])
def test_an_input_that_stands_still_is_the_same_in_short(tau):
    fade = fade_of(tau, STEP)
    long = lag_end(lagged(5.0, tau, Cubic(2.0, 0.0, 0.0, 0.0)), fade, STEP)
    np.testing.assert_allclose(held_lag_end(5.0, 2.0, fade, STEP), long, rtol=1e-14)


def test_the_cubic_through_two_points_has_their_values_and_slopes():
    cubic = hermite(1.0, -2.0, 3.0, 4.0, 0.5)
    assert value_and_slope(cubic, 0.0) == (1.0, -2.0)
    assert value_and_slope(cubic, 0.5) == pytest.approx((3.0, 4.0))
    times = np.linspace(0, 0.5, 100_001)
    values = [value_and_slope(cubic, t)[0] for t in times[::1000]]
    assert integral(cubic, 0.5) == pytest.approx(np.trapezoid(values, times[::1000]), rel=1e-3)


def test_a_machine_moves_the_same_under_a_held_force_by_either_way():
    plant = Plant(24500.0, 0.0, 0.011, 0.004, 4 / 7)
    by, state = stride_of(plant, STEP), np.array([3e3, -2e3, 0.1, 0.15])
    pushed = push(plant, 3e3, -2e3, Cubic(8e3, 0.0, 0.0, 0.0), by)
    assert pushed.start == pytest.approx(4 / 7 * 3e3 - 3 / 7 * 2e3)
    move_on(state, plant, 8e3, by)
    velocity = 0.1 + pushed.once / plant.mass
    position = 0.15 + 0.1 * STEP + pushed.twice / plant.mass
    np.testing.assert_allclose(
        state, [pushed.side_a, pushed.side_b, velocity, position], rtol=1e-13
    )
    assert pushed.end == pytest.approx(4 / 7 * pushed.side_a + 3 / 7 * pushed.side_b)
