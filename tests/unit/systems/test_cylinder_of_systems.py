"""The piston between any number of chambers against this machine's own right-hand side."""

from __future__ import annotations

import numpy as np
import pytest
from opened import opened

from mptune.params.line_table import paper_table
from mptune.params.pack import pack_machine
from mptune.params.packed import NO_TABLE
from mptune.plant import machine as plant
from mptune.plant.piston import burden_at
from mptune.plant.supplies import oil_at_pressure
from mptune.systems import cylinder
from mptune.systems.cylinder import piston_rates, two_chambers


@pytest.mark.parametrize("velocity", [-0.08, 0.0, 0.1])
def test_two_chambers_move_as_this_machine_does(boom, velocity):
    machine = pack_machine(boom, 49e3, 1.2e9, 9700.0)
    burden = burden_at(0.12, machine, NO_TABLE)
    own = np.zeros(plant.states_of(machine))
    own[plant.X], own[plant.V] = 0.12, velocity
    own[plant.PRESSURE_A], own[plant.PRESSURE_B] = 6e6, 5e6
    own[plant.OIL] = oil_at_pressure(14.5e6, machine)
    opened_a, opened_b = np.zeros(6), np.zeros(6)
    opened_a[5], opened_b[0] = 1.0, 2.0  # both supplies that have no converter
    slope, power = np.zeros(len(own)), np.zeros(plant.ENERGIES)
    lines = opened(paper_table(machine.low_pressure), opened_a, opened_b)
    plant.rates(own, lines, 0.0, machine, burden, slope, power)

    flow = machine.flow_coefficient * np.array([np.sqrt(8.5e6), -2 * np.sqrt(3e6)])
    state = np.zeros(cylinder.PRESSURE + 2)
    state[:2], state[cylinder.PRESSURE :] = own[:2], [6e6, 5e6]
    found = np.zeros(len(state))
    piston_rates(state, flow, two_chambers(machine), machine, burden, found)
    assert found[:2] == pytest.approx(slope[:2])
    assert found[cylinder.PRESSURE :] == pytest.approx(slope[[plant.PRESSURE_A, plant.PRESSURE_B]])
    assert found[cylinder.DELIVERED] == pytest.approx(power[plant.PISTON])
    assert found[cylinder.COMPRESSION] == pytest.approx(power[plant.COMPRESSION])
    shares = found[cylinder.RUBBED] + found[cylinder.MOVED]
    assert shares == pytest.approx(found[cylinder.DELIVERED])


def test_an_empty_chamber_stays_empty_until_it_is_fed(boom):
    machine = pack_machine(boom, 49e3, 1.2e9, 0.0)
    state = np.zeros(cylinder.PRESSURE + 2)
    state[cylinder.X], state[cylinder.V] = 0.1, 0.05
    found = np.zeros(len(state))
    burden = burden_at(0.1, machine, NO_TABLE)
    piston_rates(state, np.zeros(2), two_chambers(machine), machine, burden, found)
    assert found[cylinder.PRESSURE] == 0
    assert found[cylinder.PRESSURE + 1] > 0
