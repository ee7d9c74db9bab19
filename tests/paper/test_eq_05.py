"""Eq. 5: the one-step-ahead estimator against an ODE solver."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from mptune.force.cost import supply_pressures
from mptune.force.estimator import STEPS, displaced, predict, stiffness, stiffness_path
from mptune.force.search_space import search_space
from mptune.params.pack import pack_force
from mptune.plant.flow import orifice


def both(side, pressure, supplies, state, x, v, period, space, settings):
    """Return Eq. 5's prediction and the ODE solver's at constant velocity and supplies [Pa]."""
    first, second = space.first[state], space.second[state]
    counts = space.first_count[state], space.second_count[state]
    taken = displaced(side, v, settings)
    found = predict(
        pressure, supplies[first], counts[0], supplies[second], counts[1], taken,
        stiffness_path(side, x, v, period, settings), period, settings,
    )  # fmt: skip

    def slope(t, p):
        flow = sum(
            count * orifice(supplies[port] - p[0], settings.transition_pressure)
            for port, count in zip((first, second), counts, strict=True)
        )
        rate = stiffness(side, x + v * t, settings)
        return [rate * (settings.flow_coefficient * flow - taken)]

    exact = solve_ivp(slope, (0, period), [pressure], "LSODA", rtol=1e-9, atol=1.0)
    return found, exact.y[0, -1]


def cases(count, seed=1, velocity=0.11):
    random = np.random.default_rng(seed)
    for _ in range(count):
        pressure, x = random.uniform(2e6, 14e6), random.uniform(0.02, 0.28)
        v, side = random.uniform(-velocity, velocity), int(random.integers(0, 2))
        yield side, pressure, supply_pressures(2e6, 14e6), int(random.integers(0, 28)), x, v


def test_prediction_of_one_sampling_period_lies_near_the_solution(boom):
    """Four Heun steps of 2.5 ms are coarse for a pressure that settles in a few ms.

    Supplies stand 2.4 MPa apart: nine in ten predictions over states far wilder than the machine's
    lie within a sixth of that, and the typical one within a twenty-fourth.
    """
    settings, space = pack_force(boom), search_space()
    results = np.array([both(*case, 0.01, space, settings) for case in cases(150)])
    error = np.abs(results[:, 0] - results[:, 1])
    print(f"error: median {np.median(error):.0f} Pa, 90 % {np.quantile(error, 0.9):.0f} Pa, "
          f"largest {error.max():.0f} Pa")  # fmt: skip
    assert np.median(error) < 1e5
    assert np.quantile(error, 0.9) < 4e5
    assert error.max() < 1e6


def test_without_open_valves_compression_alone_remains_and_is_met_closely(boom):
    """Only the stiffness along the path changes then."""
    settings, space = pack_force(boom), search_space()
    for side, pressure, supplies, _, x, v in cases(20):
        found, exact = both(side, pressure, supplies, 0, x, v, 0.01, space, settings)
        assert found == pytest.approx(exact, abs=5.0 + 2e-4 * abs(exact - pressure))


def test_error_shrinks_as_the_square_of_the_period(boom):
    """Heun is of second order: over a fixed short span, halved steps quarter the error."""
    settings, space = pack_force(boom), search_space()
    errors = []
    for division in (1, 2, 4, 8):
        period = 0.004 / division
        worst = 0.0
        for side, _, supplies, state, x, v in cases(12, 4, 0.05):
            pressure, place = supplies[space.first[max(state, 1)]] - 5e6, x
            start = pressure
            for _ in range(division):
                pressure, _ = both(
                    side, pressure, supplies, max(state, 1), place, v, period, space, settings
                )
                place += v * period
            _, exact = both(side, start, supplies, max(state, 1), x, v, 0.004, space, settings)
            worst = max(worst, abs(pressure - exact))
        errors.append(worst)
    ratios = np.array(errors[:-1]) / errors[1:]
    print(f"{STEPS} steps over 4 ms / {{1, 2, 4, 8}}: errors {errors} Pa, ratios {ratios}")
    assert errors[-1] < errors[0] / 20
    assert ratios[-1] == pytest.approx(4, rel=0.4)


def test_the_path_of_stiffness_is_eq_4_over_the_volume(boom):
    """Both chambers, with the volumes of Table 1 and mid-stroke, by hand."""
    settings = pack_force(boom)
    for side, (area, place, dead, hose) in enumerate([
        (settings.area_a, 0.15, settings.dead_a, settings.hose_a),
        (settings.area_b, settings.stroke - 0.15, settings.dead_b, settings.hose_b),
    ]):  # fmt: skip
        volume = area * place + dead
        expected = 1 / (1 / settings.oil + hose / volume / settings.hose) / volume
        path = stiffness_path(side, 0.15, 0.0, 0.01, settings)
        np.testing.assert_allclose(path, np.full(STEPS + 1, expected), rtol=1e-14)


def test_a_moving_piston_takes_oil_from_a_and_gives_it_to_b(boom):
    settings = pack_force(boom)
    assert displaced(0, 0.1, settings) == pytest.approx(0.1 * settings.area_a)
    assert displaced(1, 0.1, settings) == pytest.approx(-0.1 * settings.area_b)
