"""Hoses as lines of a machine of any number of chambers."""

import numpy as np
import pytest
from opened import opened
from scipy.integrate import solve_ivp

from mptune.force.search_space import space_of
from mptune.params.line_table import line_table
from mptune.params.lines import SupplyLine
from mptune.params.pack import pack_chambers, pack_gains, pack_machine
from mptune.params.packed import (
    AREA,
    CHAMBER_ROWS,
    DEAD,
    HOSE,
    INERTANCE,
    LINE_ROWS,
    NO_TABLE,
    RESISTANCE,
    SIZE,
)
from mptune.plant import machine as plant
from mptune.plant.chambers import place_of, rates_of_chambers, seen_at, valve_end_of
from mptune.plant.hoses import LINE_STATES, hose_rates, rates_with_lines
from mptune.plant.piston import burden_at
from mptune.plant.supplies import oil_at_pressure
from mptune.sim.integrator import integrate, new_work
from mptune.verify.at_rest import new_memory

pytestmark = pytest.mark.compiled

LINES = line_table(
    (
        SupplyLine(kind="tank", pressure="1 MPa"),
        SupplyLine(kind="converter", between=(1, 3), share=0.45),
        SupplyLine(kind="accumulator", pressure="12 MPa"),
    ),
    1e6,
)
OPEN = np.array([[1.0, 0.7, 0.4], [0.0, 2.0, 0.3]])  # of A and B towards each line [K_v]
TICK = 5e-4


@pytest.fixture
def machine(load_boom):
    machine = pack_machine(load_boom("hose.dynamics=true"), 30e3, 1.2e9, 9700.0)
    return machine._replace(converters=1, low_pressure=1e6)


def table_of(machine, shares=(1.0, 1.0)):
    """A and B of the machine, then what is left of them; a hose of less section is as long."""
    both = np.array
    rows = {
        AREA: both([machine.area_a, -machine.area_b]),
        DEAD: both([machine.dead_a, machine.dead_b]),
        HOSE: both([machine.hose_a, machine.hose_b]),
        SIZE: both([1.0, 1.0]),
        INERTANCE: both([machine.line_inertance, machine.line_inertance_b]),
        RESISTANCE: both([machine.line_resistance, machine.line_resistance_b]),
    }
    parts = [np.array(shares), 1 - np.array(shares)]
    parts = [part for part in parts if part.all()]
    table = np.zeros((CHAMBER_ROWS, 2 * len(parts)))
    for row, whole in rows.items():
        shared = [whole / part if row in (INERTANCE, RESISTANCE) else whole * part
                  for part in parts]  # fmt: skip
        table[row] = np.concatenate(shared)
    return table


def state_of(machine, pressures, ends, flows):
    """Chambers, valves' ends and flows of as many chambers as there are pressures."""
    own = plant.states_of(machine)
    state = np.zeros(own + 3 * len(pressures) - 2)
    state[plant.X], state[plant.V] = 0.12, 0.07
    state[[plant.PRESSURE_A, plant.PRESSURE_B]] = pressures[:2]
    state[plant.OIL], state[plant.CONVERTER] = oil_at_pressure(14e6, machine), 0.01
    state[own:] = [*pressures[2:], *ends, *flows]
    return state


def rates(machine, table, state, valves):
    slope, power = np.full(len(state), np.nan), np.zeros(plant.ENERGIES)
    burden = burden_at(state[plant.X], machine, NO_TABLE)
    lines = np.vstack([LINES, valves])
    rates_of_chambers(state, lines, 1.0, machine, burden, slope, power, table)
    return slope, power


def test_two_chambers_move_as_the_machine_of_two(machine):
    state = state_of(machine, (6e6, 5e6), (6.5e6, 4.8e6), (2e-4, -1e-4))
    assert len(state) == plant.states_of(machine) + LINE_STATES
    slope, power = rates(machine, table_of(machine), state, OPEN)
    wanted, spent = np.zeros(len(state)), np.zeros(plant.ENERGIES)
    burden = burden_at(state[plant.X], machine, NO_TABLE)
    rates_with_lines(state, opened(LINES, *OPEN), 1.0, machine, burden, wanted, spent)
    assert slope == pytest.approx(wanted, rel=1e-12)
    assert power == pytest.approx(spent, rel=1e-12)


def test_a_steady_flow_costs_its_friction_and_a_drop_its_inertia(machine):
    """Oil that runs along at q loses R q; without a flow a drop of 1 MPa starts one by Δp/L."""
    hose, inert, slow = machine.hose_a, machine.line_inertance, machine.line_resistance
    steady = hose_rates(6e6 + slow * 3e-4, 6e6, 3e-4, 3e-4, hose, inert, slow, machine)
    assert steady == pytest.approx((0.0, 0.0, slow * 3e-4 * 3e-4), abs=1e-9)
    _, starts, _ = hose_rates(7e6, 6e6, 0.0, 0.0, hose, inert, slow, machine)
    assert starts == pytest.approx(1e6 / inert)
    fills, *_ = hose_rates(7e6, 6e6, 2e-4, 0.0, hose, inert, slow, machine)
    assert fills == pytest.approx(2e-4 / hose / (1 / machine.oil + 1 / machine.hose))


def test_chambers_and_hoses_cut_in_two_move_as_one(machine):
    state = state_of(machine, (6e6, 5e6), (6.5e6, 4.8e6), (2e-4, -1e-4))
    whole, power = rates(machine, table_of(machine), state, OPEN)
    shares = np.array([0.3, 0.6])
    table = table_of(machine, shares)
    flows = np.array([2e-4, -1e-4])
    parts = (*(shares * flows), *((1 - shares) * flows))
    state = state_of(machine, (6e6, 5e6) * 2, (6.5e6, 4.8e6) * 2, parts)
    valves = table[SIZE][:, None] * np.tile(OPEN, (2, 1))
    cut, spent = rates(machine, table, state, valves)
    own = plant.states_of(machine)
    assert cut[:own] == pytest.approx(whole[:own], rel=1e-8)
    assert cut[own : own + 2] == pytest.approx(whole[2:4], rel=1e-8)
    ends, along = np.split(cut[own + 2 :], 2)
    assert ends == pytest.approx(np.tile(whole[own : own + 2], 2), rel=1e-8)
    assert along[:2] + along[2:] == pytest.approx(whole[own + 2 :], rel=1e-8)
    assert spent == pytest.approx(power, rel=1e-8)


@pytest.mark.parametrize("seed", range(20))
def test_powers_close_and_a_chamber_without_a_hose_has_its_valves_at_itself(machine, seed):
    random, table = np.random.default_rng(seed), table_of(machine, (0.3, 0.6))
    table[[HOSE, INERTANCE, RESISTANCE], 2] = 0.0
    pressures = random.uniform(2e6, 14e6, (2, 4))
    state = state_of(machine, *pressures, random.uniform(-3e-4, 3e-4, 4))
    valves = random.uniform(0, 2, (4, 3)) * (random.random((4, 3)) < 0.5)
    idle = [valve_end_of(2, 4, machine), valve_end_of(2, 4, machine) + 4]
    slope, power = rates(machine, table, state, valves)
    given = power[plant.ACCUMULATOR] + power[plant.TANK]
    used = power[[plant.PISTON, plant.THROTTLING, plant.CONVERTER_FRICTION, plant.COMPRESSION]]
    assert given == pytest.approx(used.sum(), rel=1e-9, abs=1e-9 * np.abs(power).max())
    assert seen_at(2, machine, table) == place_of(2, machine)
    assert np.isnan(slope[idle]).all()  # nobody reads or writes them
    state[idle] = np.nan
    again, _ = rates(machine, table, state, valves)
    np.testing.assert_array_equal(again, slope)


def test_a_mirrored_machine_moves_in_mirror_image(machine):
    machine = machine._replace(load=0.0, load_stiffness=0.0)
    table, swapped = table_of(machine, (0.5, 0.5)), [1, 0, 3, 2]
    table[AREA], table[DEAD] = (2e-3, -2e-3, 1e-3, -1e-3), (4e-4, 4e-4, 3e-4, 3e-4)
    table[HOSE, 2:] *= 0.5
    pressures, flows = np.array([[6e6, 5e6, 3e6, 9e6], [7e6, 5e6, 4e6, 8e6]]), np.arange(4) * 1e-4
    state = state_of(machine, *pressures, flows)
    valves = np.array([[1, 0, 0], [0, 0, 1], [0, 1, 0], [0, 1, 1.0]])
    other = state_of(machine, *pressures[:, swapped], flows[swapped])
    other[plant.X], other[plant.V] = machine.stroke - state[plant.X], -state[plant.V]
    slope, power = rates(machine, table, state, valves)
    mirror, spent = rates(machine, table, other, valves[swapped])
    for one in (place_of, lambda i, m: valve_end_of(i, 4, m),
                lambda i, m: valve_end_of(i, 4, m) + 4):  # fmt: skip
        places = np.array([one(i, machine) for i in range(4)])
        assert mirror[places] == pytest.approx(slope[places[swapped]], rel=1e-8)
    assert mirror[plant.V] == pytest.approx(-slope[plant.V], rel=1e-8)
    assert spent == pytest.approx(power, rel=1e-8)


def test_integration_stays_within_50_pa_of_an_ode_solver(load_shape):
    """5 ms of four chambers, B behind a hose, between lines of which converters make two."""
    study = load_shape("four-converters", "hose.dynamics=true")
    machine, more = pack_machine(study, 30e3, 1.2e9, 9700.0), pack_chambers(study)
    assert np.count_nonzero(more.table[INERTANCE]) == 1
    memory, space = new_memory(study, machine, pack_gains(study.study.gains), 0.15), space_of(study)
    own = plant.states_of(machine)
    memory.state[plant.V] = 0.05
    memory.state[[2, 3, own, own + 1]] = 6e6, 5e6, 4e6, 9e6
    memory.state[valve_end_of(1, 4, machine)] = 5e6  # no higher: what swings is the valves' doing
    memory.valves.opening[[1, 6, 10, 13]] = 1.0
    memory.valves.target[:] = memory.valves.opening
    size = (memory.valves, space.lines, space.edge, len(memory.state), more)
    lines, scale = new_work(*size).start, np.ones(len(memory.state))
    scale[[2, 3, *range(own, own + 6)]], scale[own + 6 :] = 1e6, 1e-4

    def slope(_, y):
        found, state = np.zeros(len(y)), y * scale
        burden = burden_at(state[plant.X], machine, NO_TABLE)
        power = np.zeros(plant.ENERGIES)
        rates_of_chambers(state, lines, 0.0, machine, burden, found, power, more.table)
        return found / scale

    exact = solve_ivp(slope, (0, 10 * TICK), memory.state / scale, "LSODA", rtol=1e-10, atol=1e-11)
    work = new_work(*size)
    for tick in range(10):
        integrate(
            memory.state, memory.energy, memory.valves, 0.0, machine, NO_TABLE, 2e-3, tick * TICK,
            TICK, work, more,
        )  # fmt: skip
    error = np.abs(memory.state - exact.y[:, -1] * scale)
    print(f"pressures off by {error[[2, 3]].max():.2g} and {error[own : own + 6].max():.2g} Pa")
    assert abs(memory.state[valve_end_of(1, 4, machine)] - memory.state[plant.PRESSURE_B]) > 1e3
    assert max(error[[2, 3]].max(), error[own : own + 6].max()) < 50
    assert error[plant.X] < 1e-9


def test_lines_at_rest_stay_at_rest(load_shape):
    study = load_shape("four-converters", "hose.dynamics=true")
    machine, more = pack_machine(study, 30e3, 1.2e9, 9700.0), pack_chambers(study)
    memory = new_memory(study, machine, pack_gains(study.study.gains), 0.15)
    slope, power = np.zeros(len(memory.state)), np.zeros(plant.ENERGIES)
    burden = burden_at(0.15, machine, NO_TABLE)
    lines = np.vstack([space_of(study).lines, np.zeros((4, 4))])
    assert len(lines) == LINE_ROWS + 4
    rates_of_chambers(memory.state, lines, 0.0, machine, burden, slope, power, more.table)
    np.testing.assert_allclose(slope, 0, atol=1e-9)
