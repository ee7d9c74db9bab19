"""Eq. 8 along Eq. 5's steps instead of at both ends: the throttled energy of one period."""

import numpy as np
import pytest
from deciding import counts_of, flows, stiffness, throttled
from scipy.integrate import quad, solve_ivp

from mptune.force.cost import supply_pressures
from mptune.force.dynamic import look_ahead
from mptune.force.ports import COST, ROW, ports_of
from mptune.force.search_space import search_space
from mptune.params.pack import pack_force

STATES = 28  # of one side of the paper's machine


def energies(loss, load_boom, side, p, x, v, supplies):
    settings = pack_force(
        load_boom(
            f"controller.loss={loss}", 'controller.weight_switching="0 N"',
            'controller.weight_loss="1 N/J"', 'controller.weight_converter="0 N s/m^6"',
            'controller.pressure_min="0 MPa"', 'controller.pressure_max="30 MPa"',
        )
    )  # fmt: skip
    row, space = np.empty((ROW, STATES)), search_space()
    ports = ports_of(supplies, np.zeros(4), space)
    look_ahead(side, p, x, v, 0, ports, space, settings, row)
    return row[COST].copy(), settings, space


def exact(side, p, x, v, supplies, state, settings, space):
    """The energy that the valves throttle, by an ODE solver [J]."""
    counts = counts_of(space, state)
    taken = (settings.area_a, -settings.area_b)[side] * v

    def slope(t, y):
        flow = sum(flows(y[0], counts, supplies, settings)) - taken
        return [stiffness(side, x + v * t, settings) * flow]

    def power(t):
        return throttled(run.sol(t)[0], counts, supplies, settings)

    period = settings.sampling_period
    run = solve_ivp(slope, (0, period), [p], "LSODA", rtol=1e-8, atol=1.0, dense_output=True)
    return quad(power, 0, period, limit=200)[0]


def test_along_the_path_it_lies_nearer_to_what_is_throttled(load_boom):
    """A pressure settles in a few ms: the ends take its first, large power for half of T_S."""
    random = np.random.default_rng(4)
    errors = {"ends": [], "path": []}
    for number in range(6):
        side, p, v = number % 2, random.uniform(4e6, 12e6), random.uniform(-0.1, 0.1)
        supplies = supply_pressures(2e6, 14e6)
        found = {loss: energies(loss, load_boom, side, p, 0.15, v, supplies) for loss in errors}
        _, settings, space = found["path"]
        for state in random.integers(1, STATES, 6):
            truth = exact(side, p, 0.15, v, supplies, state, settings, space)
            for loss, one in errors.items():
                one.append(found[loss][0][state] - truth)
    mean = {loss: float(np.abs(one).mean()) for loss, one in errors.items()}
    print(f"mean deviation [J]: {mean}; biases {[float(np.mean(e)) for e in errors.values()]}")
    assert mean["path"] < 0.5 * mean["ends"]
    assert np.mean(errors["ends"]) > 0  # the ends exaggerate


def test_where_the_power_is_constant_both_are_the_same(load_boom):
    """Nothing flows through the closed state; at rest a chamber at its supply stays there."""
    supplies = supply_pressures(2e6, 14e6)
    ends, path = (
        energies(loss, load_boom, 0, supplies[2], 0.15, 0.0, supplies)[0]
        for loss in ("ends", "path")
    )
    assert ends[0] == path[0] == 0
    assert path[3] == pytest.approx(ends[3], abs=1e-9)
    assert abs(path[5] - ends[5]) > 1  # J
