"""A machine of any number of chambers against the machine of two, and a chamber cut in two."""

import numpy as np
import pytest
from opened import opened

from mptune.params.line_table import line_table
from mptune.params.lines import SupplyLine
from mptune.params.pack import pack_chambers, pack_machine
from mptune.params.packed import AREA, CHAMBER_ROWS, DEAD, HOSE, LINE_ROWS, NO_TABLE, SIZE
from mptune.plant import machine as plant
from mptune.plant.chamber_valves import open_valves_of_chambers
from mptune.plant.chambers import chambers_force, rates_of_chambers
from mptune.plant.piston import burden_at
from mptune.plant.supplies import oil_at_pressure
from mptune.plant.valve import shut_valves

LINES = line_table(
    (
        SupplyLine(kind="tank", pressure="1 MPa"),
        SupplyLine(kind="constant", pressure="6 MPa"),
        SupplyLine(kind="accumulator", pressure="12 MPa"),
    ),
    1e6,
)
CONVERTED = line_table(
    (
        SupplyLine(kind="tank", pressure="1 MPa"),
        SupplyLine(kind="converter", between=(1, 3), share=0.45),
        SupplyLine(kind="accumulator", pressure="12 MPa"),
    ),
    1e6,
)
OPEN = np.array([[1.0, 0.7, 0.4], [0.0, 2.0, 0.3]])  # of A and B towards each line [K_v]
TRAVEL = 0.075  # m, of the converter
# What makes the middle line, and where the piston of a converter stands.
MIDDLES = [(LINES, 0.0), (CONVERTED, 0.01), (CONVERTED, TRAVEL), (CONVERTED, -TRAVEL)]


@pytest.fixture
def machine(boom):
    machine = pack_machine(boom, 30e3, 1.2e9, 9700.0)
    return machine._replace(converters=1, converter_travel=TRAVEL, low_pressure=1e6)


def state_of(machine, *pressures, place=0.0):
    state = np.zeros(plant.states_of(machine) + max(len(pressures) - 2, 0))
    state[plant.X], state[plant.V] = 0.12, 0.07
    state[[plant.PRESSURE_A, plant.PRESSURE_B]] = pressures[:2]
    state[plant.OIL] = oil_at_pressure(14e6, machine)
    state[plant.CONVERTER] = place
    state[plant.states_of(machine) :] = pressures[2:]
    return state


def table_of(machine, shares=(1.0, 1.0)):
    """A and B of the machine, then what is left of them."""
    area = np.array([machine.area_a, -machine.area_b])
    dead, hose = np.array([machine.dead_a, machine.dead_b]), [machine.hose_a, machine.hose_b]
    parts = [np.array(shares), 1 - np.array(shares)]
    parts = [part for part in parts if part.all()]
    table = np.zeros((CHAMBER_ROWS, 2 * len(parts)))
    for row, whole in ((AREA, area), (DEAD, dead), (HOSE, hose), (SIZE, [1.0, 1.0])):
        table[row] = np.concatenate([part * whole for part in parts])
    return table


def run(machine, table, state, lines=LINES):
    count = table.shape[1]
    lines = np.vstack([lines, np.zeros((count, 3))])
    lines[LINE_ROWS:] = table[SIZE][:, None] * np.tile(OPEN, (count // 2, 1))
    slope, power = np.zeros(len(state)), np.zeros(plant.ENERGIES)
    burden = burden_at(state[plant.X], machine, NO_TABLE)
    rates_of_chambers(state, lines, 1.0, machine, burden, slope, power, table)
    return slope, power


@pytest.mark.parametrize("pressures", [(6e6, 5e6), (4e6, 9e6), (9e6, 8e6)])
@pytest.mark.parametrize(("middle", "place"), [*MIDDLES, ("pump", 0.0)])
def test_two_chambers_move_as_the_machine_of_two(machine, middle, place, pressures):
    if isinstance(middle, str):  # in the accumulator's place one that follows the load, one way
        middle, machine = LINES, machine._replace(
            accumulator_volume=0.0, pump_lag=0.06, pump_margin=1e6, pump_standby=2e6
        )  # fmt: skip
    state = state_of(machine, *pressures, place=place)
    slope, power = run(machine, table_of(machine), state, middle)
    wanted, spent = np.zeros(len(state)), np.zeros(plant.ENERGIES)
    burden = burden_at(state[plant.X], machine, NO_TABLE)
    lines = opened(middle, *OPEN)
    plant.rates(state, lines, 1.0, machine, burden, wanted, spent)
    assert slope == pytest.approx(wanted, rel=1e-12)
    assert power == pytest.approx(spent, rel=1e-12)


@pytest.mark.parametrize(("middle", "place"), MIDDLES)
def test_chambers_cut_in_two_move_as_one(machine, middle, place):
    whole, power = run(machine, table_of(machine), state_of(machine, 6e6, 5e6, place=place), middle)
    table = table_of(machine, (0.3, 0.6))
    state = state_of(machine, 6e6, 5e6, 6e6, 5e6, place=place)
    cut, spent = run(machine, table, state, middle)
    own = plant.states_of(machine)
    assert cut[:own] == pytest.approx(whole, rel=1e-8, abs=1e-9)
    assert cut[own:] == pytest.approx(whole[[plant.PRESSURE_A, plant.PRESSURE_B]], rel=1e-8)
    assert spent == pytest.approx(power, rel=1e-8, abs=1e-6)
    force = machine.area_a * 6e6 - machine.area_b * 5e6
    assert chambers_force(state, machine, table) == pytest.approx(force)


@pytest.mark.parametrize(("middle", "place"), MIDDLES)
def test_a_mirrored_machine_moves_in_mirror_image(machine, middle, place):
    """Equal areas, valves and volumes in pairs; sides, place, velocity and load change places."""
    machine = machine._replace(load=0.0, load_stiffness=0.0)
    table = table_of(machine, (0.5, 0.5))
    table[AREA] = 2e-3, -2e-3, 1e-3, -1e-3
    table[DEAD] = 4e-4, 4e-4, 3e-4, 3e-4
    table[HOSE], table[SIZE] = 1e-4, (1.0, 1.0, 0.5, 0.5)
    state = state_of(machine, 6e6, 5e6, 3e6, 9e6, place=place)
    lines = np.vstack([middle, np.array([[1, 0, 0], [0, 0, 1], [0, 1, 0], [0, 1, 1.0]])])
    other, swapped = state_of(machine, 5e6, 6e6, 9e6, 3e6, place=place), [1, 0, 3, 2]
    other[plant.X], other[plant.V] = machine.stroke - state[plant.X], -state[plant.V]
    mirrored = lines.copy()
    mirrored[LINE_ROWS:] = lines[LINE_ROWS:][swapped]
    found = []
    for one, opening in ((state, lines), (other, mirrored)):
        slope, power = np.zeros(len(state)), np.zeros(plant.ENERGIES)
        burden = burden_at(one[plant.X], machine, NO_TABLE)
        rates_of_chambers(one, opening, 0.0, machine, burden, slope, power, table)
        found.append((slope, power))
    (slope, power), (mirror, spent) = found
    own = plant.states_of(machine)
    places = [plant.PRESSURE_A, plant.PRESSURE_B, own, own + 1]
    assert mirror[places] == pytest.approx(slope[places][swapped], rel=1e-8)
    assert mirror[plant.V] == pytest.approx(-slope[plant.V], rel=1e-8)
    assert mirror[plant.CONVERTER] == pytest.approx(slope[plant.CONVERTER], rel=1e-8)
    assert spent == pytest.approx(power, rel=1e-8)


def random_case(machine, seed):
    """Four chambers anywhere, valves partly open, the converter anywhere or at an end."""
    random = np.random.default_rng(seed)
    table = table_of(machine, (0.3, 0.6))
    place = random.choice([TRAVEL, -TRAVEL, random.uniform(-TRAVEL, TRAVEL)])
    state = state_of(machine, *random.uniform(2e6, 14e6, 4), place=place)
    lines = np.vstack([CONVERTED, random.uniform(0, 2, (4, 3)) * (random.random((4, 3)) < 0.5)])
    slope, power = np.full(len(state), np.nan), np.zeros(plant.ENERGIES)
    burden = burden_at(state[plant.X], machine, NO_TABLE)
    rates_of_chambers(state, lines, 0.0, machine, burden, slope, power, table)
    return state, lines, slope, power


@pytest.mark.parametrize("seed", range(40))
def test_powers_close_and_oil_is_kept_at_every_instant(machine, seed):
    """Also at a converter that stands at its end, and between chambers that exchange through it."""
    state, lines, slope, power = random_case(machine, seed)
    given = power[plant.ACCUMULATOR] + power[plant.TANK]
    used = power[[plant.PISTON, plant.THROTTLING, plant.CONVERTER_FRICTION, plant.COMPRESSION]]
    assert given == pytest.approx(used.sum(), abs=1e-9 * (np.abs(power).max() + 1))
    assert power[plant.THROTTLING] >= 0
    assert power[plant.CONVERTER_FRICTION] >= -1e-2  # W: the port's pressure is known to 1 Pa
    moved = slope[plant.CONVERTER]
    if not lines[LINE_ROWS:, 1].any():
        assert moved == 0
    elif abs(state[plant.CONVERTER]) == TRAVEL:  # which it does not leave outwards
        assert moved * np.sign(state[plant.CONVERTER]) < 1e-6


@pytest.mark.parametrize("seed", range(40))
def test_a_port_between_four_chambers_solves_its_equation(machine, seed):
    """What friction takes is its pressure times the flow, whichever way that goes."""
    state, _, slope, power = random_case(machine, seed)
    drawn = -slope[plant.CONVERTER] * machine.converter_area
    if abs(state[plant.CONVERTER]) == TRAVEL or drawn == 0:
        return
    root = np.hypot(drawn, 2e-6)
    lost = machine.converter_friction * drawn / root * drawn
    assert power[plant.CONVERTER_FRICTION] == pytest.approx(lost, abs=2 * abs(drawn) + 1e-9)


def test_open_valves_are_sized_chamber_by_chamber(load_shape):
    table = pack_chambers(load_shape("four-chamber")).table
    edge = np.array([[0.0, 2.0, 2.0], [1.0, 1.0, 3.0]])  # none to the middle line
    valves = shut_valves(12)
    valves.opening[[0, 4, 8, 11]] = 1.0, 0.5, 1.0, 0.25
    found = np.full((LINE_ROWS + 4, 3), np.nan)
    open_valves_of_chambers(valves, edge, LINES, table, found)
    np.testing.assert_array_equal(found[:LINE_ROWS], LINES)
    wanted = [[2.0, 0, 0], [0, 0, 0.5], [0, 0, 0.5 * 3], [0, 0, 0.5 * 3 * 0.25]]
    np.testing.assert_array_equal(found[LINE_ROWS:], wanted)
