"""The decision of ref. 16: settled pressures, and what a change of pressure costs."""

import numpy as np
import pytest
from deciding import counts_of, flows, stiffness, throttled

from mptune.force.cost import supply_pressures
from mptune.force.ports import BARRED, COST, PRESSURE, ROW, ports_of
from mptune.force.search_space import search_space
from mptune.force.select import decide
from mptune.force.steady import settle
from mptune.params.pack import pack_force

STATES = 28  # of one side of the paper's machine

COUNT = 30 if hasattr(decide, "py_func") else 3


def settings_of(load_boom, *options):
    model = 'controller.force_model="steady-state"'
    return pack_force(load_boom(model, *options)), search_space()


def settled_row(side, pressure, x, v, supplies, settings, space, converters=(0, 0, 0, 0)):
    row = np.empty((ROW, STATES))
    ports = ports_of(supplies, np.array(converters, float), space)
    settle(side, pressure, x, v, 0, ports, space, settings, row)
    return row


@pytest.mark.parametrize("side", [0, 1])
def test_settled_pressures_pass_what_the_piston_takes(load_boom, side):
    settings, space = settings_of(load_boom)
    random = np.random.default_rng(2)
    for _ in range(COUNT):
        v, supplies = random.uniform(-0.12, 0.12), supply_pressures(2e6, random.uniform(11e6, 16e6))
        row = settled_row(side, 6e6, 0.15, v, supplies, settings, space)
        taken = (settings.area_a, -settings.area_b)[side] * v
        for state in range(1, STATES):
            passed = sum(flows(row[PRESSURE, state], counts_of(space, state), supplies, settings))
            assert passed == pytest.approx(taken, abs=1e-6 * settings.area_a * 0.1)


@pytest.mark.parametrize("side", [0, 1])
def test_at_rest_a_port_settles_at_its_supply_and_crossflow_between_two(load_boom, side):
    settings, space = settings_of(load_boom)
    supplies = supply_pressures(2e6, 14e6)
    row = settled_row(side, 6e6, 0.15, 0.0, supplies, settings, space)
    np.testing.assert_allclose(row[PRESSURE, 1:7], supplies, atol=1.0)
    np.testing.assert_allclose(row[PRESSURE, 7:13], supplies, atol=1.0)
    middles = (supplies[1:] + supplies[:-1]) / 2
    np.testing.assert_allclose(row[PRESSURE, 13:18], middles, atol=1.0)
    # Two valves of the lower and one of the upper supply: 4 (p − p_1) = p_2 − p.
    np.testing.assert_allclose(
        row[PRESSURE, 18::2], (4 * supplies[:-1] + supplies[1:]) / 5, atol=1.0
    )


def test_the_closed_state_is_barred_while_the_piston_moves_and_keeps_its_pressure_at_rest(
    load_boom,
):
    settings, space = settings_of(load_boom)
    supplies = supply_pressures(2e6, 14e6)
    assert settings.rest_velocity == pytest.approx(1e-4)
    for v, barred in ((0.0, False), (9e-5, False), (1.1e-4, True), (-0.1, True)):
        row = settled_row(0, 6.3e6, 0.15, v, supplies, settings, space)
        assert row[PRESSURE, 0] == 6.3e6
        assert (row[COST, 0] >= BARRED) == barred
        state, _ = decide(
            6.3e6 * settings.area_a - 5e6 * settings.area_b, 6.3e6, 5e6, 0.15, v, supplies,
            np.zeros(4), 0, 0, space, settings,
        )  # fmt: skip
        assert (state == 0) != barred


def test_a_change_of_pressure_costs_the_energy_of_compression(load_boom):
    """V Δp²/(2 B̂), both from Table 1 at mid-stroke."""
    supplies = supply_pressures(2e6, 14e6)
    without, space = settings_of(load_boom)
    weighed, _ = settings_of(load_boom, 'controller.weight_compression="60 N/J"')
    for side in (0, 1):
        rows = [settled_row(side, 6e6, 0.15, 0.05, supplies, s, space) for s in (without, weighed)]
        change = rows[0][PRESSURE] - 6e6
        energy = change**2 / (2 * stiffness(side, 0.15, without))
        np.testing.assert_allclose(rows[1][COST] - rows[0][COST], 60 * energy, rtol=1e-6, atol=1e-6)
        assert energy[6] > 10  # J, towards the highest supply: not small beside the losses


def test_losses_are_the_settled_power_over_the_period(load_boom):
    supplies = supply_pressures(2e6, 14e6)
    settings, space = settings_of(
        load_boom, 'controller.weight_switching="0 N"', 'controller.weight_loss="80 N/J"'
    )
    row = settled_row(1, 6e6, 0.15, 0.08, supplies, settings, space)
    for state in range(1, STATES):
        if settings.pressure_min < row[PRESSURE, state] < settings.pressure_max:
            power = throttled(row[PRESSURE, state], counts_of(space, state), supplies, settings)
            assert row[COST, state] == pytest.approx(80 * 0.01 * power, rel=1e-6)
