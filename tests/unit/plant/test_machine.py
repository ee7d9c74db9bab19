"""The whole machine: its energies close, its mirror image moves alike, its integration is exact."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from opened import opened
from scipy.integrate import solve_ivp

from mptune.force.search_space import search_space
from mptune.params.line_table import paper_table
from mptune.params.pack import pack_gains, pack_machine
from mptune.params.packed import NO_TABLE
from mptune.plant import machine as plant
from mptune.plant.piston import burden_at
from mptune.plant.supplies import accumulator_pressure, oil_at_pressure
from mptune.sim.integrator import integrate, new_work
from mptune.verify.verify import new_memory

STATES = plant.CONVERTER + 4  # of the paper's machine
TICK = 5e-4
IN = [plant.ACCUMULATOR, plant.TANK]
OUT = [plant.PISTON, plant.THROTTLING, plant.CONVERTER_FRICTION, plant.COMPRESSION]


@pytest.fixture(scope="module")
def machine(boom):
    return pack_machine(boom, 24500.0, 1.2e9, 9700.0)


def evaluate(state, open_a, open_b, machine, pumping=0.0):
    lines = opened(paper_table(machine.low_pressure), open_a, open_b)
    return evaluate_with(state, lines, machine, pumping)


def evaluate_with(state, lines, machine, pumping=0.0):
    slope, power = np.empty(STATES), np.empty(plant.ENERGIES)
    plant.rates(
        state,
        lines,
        pumping,
        machine,
        burden_at(state[0], machine, NO_TABLE),
        slope,
        power,
    )
    return slope, power


def random_state(random, machine, spread=1.0):
    state = np.zeros(STATES)
    state[plant.X] = random.uniform(0.03, 0.27)
    state[plant.V] = random.uniform(-0.1, 0.1)
    state[2:4] = random.uniform(2e6, 14e6, 2)
    state[5:9] = spread * random.uniform(-0.076, 0.076, 4)
    state[plant.OIL] = oil_at_pressure(random.uniform(11e6, 16e6), machine)
    return state


def random_openings(random):
    return random.uniform(0, 2, (2, 6)) * (random.random((2, 6)) < 0.4)


@given(seed=st.integers(0, 2**31))
def test_powers_close_at_every_instant(machine, seed):
    """What the supplies give is piston work, throttling, converter friction and compression."""
    random = np.random.default_rng(seed)
    state, openings = random_state(random, machine), random_openings(random)
    _, power = evaluate(state, *openings, machine)
    size = np.abs(power).max() + 1
    assert power[IN].sum() == pytest.approx(power[OUT].sum(), abs=1e-9 * size)
    assert power[plant.THROTTLING] >= 0
    assert power[plant.CONVERTER_FRICTION] >= -1e-2  # W: the port's pressure is known to 1 Pa


@given(seed=st.integers(0, 2**31))
def test_powers_agree_with_the_state_s_own_rates(machine, seed):
    """Each power from the slopes it must show in, not from the flows it was summed over."""
    random = np.random.default_rng(seed)
    state, openings = random_state(random, machine, 0.5), random_openings(random)
    slope, power = evaluate(state, *openings, machine)
    high = accumulator_pressure(state[plant.OIL], machine)
    spilled = power[plant.RELIEF] / high
    assert power[plant.ACCUMULATOR] == pytest.approx(-high * (slope[plant.OIL] + spilled), abs=1e-6)
    force = machine.area_a * state[2] - machine.area_b * state[3]
    assert power[plant.PISTON] == pytest.approx(force * state[plant.V], abs=1e-9)
    for converter in range(4):
        if openings[:, converter + 1].sum() == 0:
            assert slope[plant.CONVERTER + converter] == 0


def test_with_all_valves_shut_only_the_trapped_oil_moves(machine):
    random = np.random.default_rng(1)
    for _ in range(20):
        state = random_state(random, machine)
        slope, power = evaluate(state, np.zeros(6), np.zeros(6), machine)
        np.testing.assert_array_equal(slope[5:9], 0)
        assert power[plant.THROTTLING] == power[plant.ACCUMULATOR] == 0
        assert np.sign(slope[2]) == -np.sign(state[plant.V]) == -np.sign(slope[3])


def test_a_full_converter_lets_nothing_in_and_oil_out(machine):
    """Supply 3 (6.8 MPa) against chambers above it, then below it."""
    open_a = np.array([0, 0, 1.0, 0, 0, 0])
    for pressure, moves in ((9e6, False), (4e6, True)):
        state = np.zeros(STATES)
        state[[0, 2, 3, 6]] = 0.15, pressure, pressure, machine.converter_travel
        state[plant.OIL] = oil_at_pressure(14e6, machine)
        slope, _ = evaluate(state, open_a, np.zeros(6), machine)
        print(f"chamber at {pressure / 1e6:g} MPa: full converter moves {slope[6]:.2e} m/s")
        assert slope[6] < -0.01 if moves else abs(slope[6]) < 1e-6


def test_pressure_does_not_fall_below_zero(machine):
    state = np.zeros(STATES)
    state[[0, 1, 3]] = 0.15, 0.1, 5e6
    state[plant.OIL] = oil_at_pressure(14e6, machine)
    slope, _ = evaluate(state, np.zeros(6), np.zeros(6), machine)
    assert slope[plant.PRESSURE_A] == 0.0
    state[1] = -0.1
    slope, _ = evaluate(state, np.zeros(6), np.zeros(6), machine)
    assert slope[plant.PRESSURE_A] > 0


def test_pump_fills_the_accumulator_and_the_relief_valve_empties_it(machine):
    state = np.zeros(STATES)
    state[[0, 2, 3]] = 0.15, 5e6, 5e6
    shut = np.zeros(6), np.zeros(6)
    state[plant.OIL] = oil_at_pressure(14.5e6, machine)
    slope, power = evaluate(state, *shut, machine, 1.0)
    assert slope[plant.OIL] == machine.pump_flow
    assert power[plant.PUMP] == pytest.approx(14.5e6 * machine.pump_flow)
    state[plant.OIL] = oil_at_pressure(machine.relief_pressure + 1e6, machine)
    slope, power = evaluate(state, *shut, machine)
    assert slope[plant.OIL] < 0 < power[plant.RELIEF]


def test_the_mirrored_machine_moves_alike(machine):
    """Equal areas; both sides, the position and the load change places."""
    random = np.random.default_rng(8)
    mean = 0.5 * (machine.area_a + machine.area_b)
    one = machine._replace(area_a=mean, area_b=mean)
    other = one._replace(
        dead_a=one.dead_b, dead_b=one.dead_a, hose_a=one.hose_b, hose_b=one.hose_a, load=-one.load
    )
    for _ in range(50):
        state, openings = random_state(random, machine), random_openings(random)
        mirror = state[[0, 1, 3, 2, *range(4, 9)]]
        mirror[0], mirror[1] = one.stroke - state[0], -state[1]
        slope, power = evaluate(state, *openings, one)
        found, mirrored = evaluate(mirror, *openings[::-1], other)
        expected = slope[[0, 1, 3, 2, *range(4, 9)]] * [-1, -1, 1, 1, 1, 1, 1, 1, 1]
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-9)
        np.testing.assert_allclose(mirrored, power, rtol=1e-6, atol=1e-2)


def room(memory, machine):
    space = search_space(lines=paper_table(machine.low_pressure))
    return new_work(memory.valves, space.lines, space.edge, len(memory.state))


def simulate(memory, machine, ticks):
    """Integrate as the closed loop does, calm rule and all."""
    work = room(memory, machine)
    for tick in range(ticks):
        advance(memory, machine, tick, work)


def advance(memory, machine, tick, work):
    state, energy, valves = memory.state, memory.energy, memory.valves
    integrate(state, energy, valves, 0.0, machine, NO_TABLE, 2e-3, tick * TICK, TICK, work)


def settled(boom, machine, state, states):
    memory, space = new_memory(boom, machine, pack_gains(boom.study.gains), 0.15), search_space()
    memory.state[:STATES] = state
    opening = np.concatenate([space.valves[i] for i in states]).astype(float)
    for array in (memory.valves.opening, memory.valves.target, memory.valves.commanded):
        array[:] = opening
    return memory


def solver(memory, machine, span):
    lines = room(memory, machine).start
    scale = np.array([1, 1, 1e6, 1e6, 1e-3, 1, 1, 1, 1])

    def slope(_, y):
        return evaluate_with(y * scale, lines, machine)[0] / scale

    start = memory.state[:STATES] / scale
    found = solve_ivp(slope, (0, span), start, "LSODA", rtol=1e-10, atol=1e-11)
    return found.y[:, -1] * scale


@pytest.mark.compiled
def test_integration_stays_within_50_pa_of_an_ode_solver(boom, machine):
    """10 ms between two switchings, whole valves open, from states wilder than the loop's."""
    random = np.random.default_rng(4)
    pressure, place = [], []
    for _ in range(40):
        states = random.integers(0, 28, 2)
        memory = settled(boom, machine, random_state(random, machine, 0.8), states)
        exact = solver(memory, machine, 0.01)
        simulate(memory, machine, 20)
        pressure.append(np.abs(memory.state[2:4] - exact[2:4]).max())
        place.append(abs(memory.state[0] - exact[0]))
    print(f"pressures: median {np.median(pressure):.2g} Pa, largest {max(pressure):.3g} Pa; "
          f"position: largest {max(place):.1e} m")  # fmt: skip
    assert max(pressure) < 50
    assert max(place) < 1e-9


@pytest.mark.compiled
def test_integration_at_rest_in_long_steps_is_as_good(boom, machine):
    """Shut valves and a slow piston: the calm rule takes two steps in a tick, not five."""
    state = random_state(np.random.default_rng(2), machine)
    state[1], state[2], state[3] = 1e-5, 6.4e6, 6e6
    memory = settled(boom, machine, state, (0, 0))
    exact = solver(memory, machine, 0.05)
    simulate(memory, machine, 100)
    error = np.abs(memory.state[2:4] - exact[2:4]).max()
    print(f"after 50 ms at rest {error:.2g} Pa off")
    assert error < 50


def test_kinetic_energy_is_what_the_piston_s_work_leaves(boom, machine):
    """Piston work less friction and load, from the trajectory, is the change of m v²/2."""
    random = np.random.default_rng(6)
    memory = settled(boom, machine, random_state(random, machine, 0.5), (5, 2))
    before, work = memory.state.copy(), room(memory, machine)
    lost = 0.0
    for tick in range(20):
        v = memory.state[1]
        advance(memory, machine, tick, work)
        mean = 0.5 * (v + memory.state[1])
        lost += TICK * mean * (plant.friction(mean, machine) + machine.load)
    gained = 0.5 * machine.mass * (memory.state[1] ** 2 - before[1] ** 2)
    print(f"work {memory.energy[plant.PISTON]:.3f} J, gained {gained:.3f} J, lost {lost:.3f} J")
    assert memory.energy[plant.PISTON] == pytest.approx(gained + lost, rel=1e-3)
    # The accumulator's share is p dV of its own oil.
    ends = [accumulator_pressure(state[plant.OIL], machine) for state in (before, memory.state)]
    given = (before[plant.OIL] - memory.state[plant.OIL]) * np.mean(ends)
    assert memory.energy[plant.ACCUMULATOR] == pytest.approx(given, rel=1e-3)


@pytest.mark.compiled
def test_compiled_rates_equal_interpreted_ones(machine):
    random = np.random.default_rng(9)
    for _ in range(30):
        state, openings = random_state(random, machine), random_openings(random)
        slope, power = np.empty(STATES), np.empty(plant.ENERGIES)
        plant.rates.py_func(
            state,
            opened(paper_table(machine.low_pressure), *openings),
            1.0,
            machine,
            burden_at(state[0], machine, NO_TABLE),
            slope,
            power,
        )
        found = evaluate(state, *openings, machine, 1.0)
        np.testing.assert_allclose(found[0], slope, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(found[1], power, rtol=1e-9, atol=1e-9)
