"""Accumulator and converter ports."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from mptune.params.line_table import paper_table
from mptune.params.pack import pack_machine
from mptune.params.packed import BASE, SHARE
from mptune.plant.flow import orifice
from mptune.plant.port import port_pressure
from mptune.plant.supplies import accumulator_pressure, line_pressure, oil_at_pressure

FRICTION_FLOW = 2e-6  # m³/s
pressures = st.floats(0.0, 17e6)
openings = st.one_of(st.just(0.0), st.just(2.0), st.floats(0.01, 2.0))


ports = st.tuples(st.floats(2e6, 15e6), openings, openings, pressures, pressures).filter(
    lambda port: port[1] + port[2] > 0
)


@pytest.fixture(scope="module")
def machine(boom):
    return pack_machine(boom, 24500.0, 1.2e9, 9700.0)


def flows(machine, port, open_a, open_b, pressure_a, pressure_b):
    """Return the flows out of the port into both chambers."""
    transition, scale = machine.transition_pressure, machine.flow_coefficient
    to_a = scale * open_a * orifice(port - pressure_a, transition)
    return to_a, scale * open_b * orifice(port - pressure_b, transition)


@given(pressure=st.floats(10.01e6, 30e6))
def test_oil_and_pressure_of_the_accumulator_go_there_and_back(machine, pressure):
    oil = oil_at_pressure(pressure, machine)
    assert 0 < oil < machine.accumulator_volume
    assert accumulator_pressure(oil, machine) == pytest.approx(pressure, rel=1e-12)


def test_compression_is_polytropic(machine):
    """p V^n is the same at any filling; an empty accumulator stands at its precharge."""
    oil = np.linspace(0, 2e-3, 9)
    gas = machine.accumulator_volume - oil
    product = [accumulator_pressure(o, machine) * g**1.4 for o, g in zip(oil, gas, strict=True)]
    np.testing.assert_allclose(product, product[0], rtol=1e-12)
    assert accumulator_pressure(0.0, machine) == machine.accumulator_precharge
    assert accumulator_pressure(-1e-4, machine) == machine.accumulator_precharge


def test_shares_reproduce_eq_13():
    low, high = 2e6, 14e6
    table = paper_table(low)
    found = [line_pressure(table[BASE, i], table[SHARE, i], high) for i in range(6)]
    assert found == pytest.approx([2e6, 4.4e6, 6.8e6, 9.2e6, 11.6e6, 14e6], rel=1e-15)


def exact_pressure(machine, ideal, *ports):
    """Return the port's pressure by Brent's method, from p + friction · s(q(p)) = ideal."""

    def excess(port):
        flow = sum(flows(machine, port, *ports))
        return port - ideal + machine.converter_friction * flow / math.hypot(flow, FRICTION_FLOW)

    reach = machine.converter_friction + 1
    return brentq(excess, ideal - reach, ideal + reach, xtol=1e-6)


def test_port_pressure_solves_its_equation_within_a_pascal(machine):
    """Whole and partial openings; every other time chamber A stands near the port's pressure."""
    random, error = np.random.default_rng(5), []
    for count in range(3000):
        open_a, open_b = (random.choice([0.0, 1.0, 2.0, random.uniform(0.01, 2)]) for _ in "ab")
        if open_a + open_b == 0:
            continue
        ideal, *chambers = random.uniform([2e6, 0, 0], [15e6, 17e6, 17e6])
        if count % 2:
            chambers[0] = ideal + random.uniform(-3e5, 3e5)
        found = port_pressure(ideal, open_a, open_b, *chambers, 0, machine)
        error.append(abs(found - exact_pressure(machine, ideal, open_a, open_b, *chambers)))
    wrong = sum(e > 1 for e in error)
    print(f"{wrong} of {len(error)} off by more than 1 Pa, the worst by {max(error):.3g} Pa")
    assert max(error) <= 1


@pytest.mark.parametrize(
    "port",
    [
        (2e6, 0.125, 2.0, 0.0, 1.821622e6),
        (9796297.9, 2.0, 0.195, 9573419.7, 14425896.3),
    ],
)
def test_port_pressure_where_newton_steps_jump_from_side_to_side(machine, port):
    """Crossflow through friction's steep middle: steps overshoot by turns, to either side."""
    found, exact = port_pressure(*port, 0, machine), exact_pressure(machine, *port)
    print(f"found {found:.0f} Pa, exact {exact:.0f} Pa")
    assert found == pytest.approx(exact, abs=1.0)


@given(data=ports)
def test_friction_works_against_the_flow(machine, data):
    """Oil that leaves the port leaves below the ideal pressure, oil that enters above it."""
    ideal, open_a, open_b, p_a, p_b = data
    port = port_pressure(ideal, open_a, open_b, p_a, p_b, 0, machine)
    net = sum(flows(machine, port, open_a, open_b, p_a, p_b))
    assert abs(ideal - port) <= machine.converter_friction + 1
    if abs(net) > FRICTION_FLOW:
        assert (ideal - port) * net > 0


@given(end=st.sampled_from([-1, 1]), data=ports)
def test_a_blocked_piston_passes_flow_in_one_direction_only(machine, end, data):
    ideal, open_a, open_b, p_a, p_b = data
    free = port_pressure(ideal, open_a, open_b, p_a, p_b, 0, machine)
    found = port_pressure(ideal, open_a, open_b, p_a, p_b, end, machine)
    net = sum(flows(machine, free, open_a, open_b, p_a, p_b))  # out of the port: the piston empties
    if net * end >= 0:  # a full one empties, an empty one fills
        assert found == free
    else:
        leak = abs(sum(flows(machine, found, open_a, open_b, p_a, p_b)))
        assert leak < 5e-9  # m³/s: what a pascal drives through four open valves


@pytest.mark.parametrize("end", [-1, 1])
def test_chambers_exchange_through_the_port_of_a_blocked_piston(machine, end):
    """Equal valves to both: the port stands half-way, all that leaves one enters the other."""
    ideal = 8e6 + end * -4e6  # draws the piston towards its end
    port = port_pressure(ideal, 1.0, 1.0, 7e6, 9e6, end, machine)
    into_a, into_b = flows(machine, port, 1.0, 1.0, 7e6, 9e6)
    print(f"port at {port / 1e6:.4f} MPa, {6e4 * into_a:.3f} and {6e4 * into_b:.3f} l/min")
    assert port == pytest.approx(8e6, abs=1)
    assert into_a > 1e-4
    assert into_b == pytest.approx(-into_a, rel=1e-6)


@pytest.mark.parametrize("end", [-1, 1])
def test_one_chamber_alone_gets_nothing_from_a_blocked_piston(machine, end):
    for open_a, open_b in ((2.0, 0.0), (0.0, 2.0)):
        port = port_pressure(8e6 - end * 4e6, open_a, open_b, 8e6, 8e6, end, machine)
        assert sum(flows(machine, port, open_a, open_b, 8e6, 8e6)) == pytest.approx(0, abs=1e-9)
