"""The force loop on frozen chambers: against another solver, another controller, and its limits."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import lfilter, medfilt

from mptune.force.controller import ForceController, Measured
from mptune.force.cost import supply_pressures
from mptune.force.search_space import search_space
from mptune.identify import experiment
from mptune.identify.experiment import Loop, chambers_at, run_force_loop
from mptune.params.pack import pack_force, pack_machine, pack_signals

LOW, HIGH = 2e6, 14e6
SUPPLIES = supply_pressures(LOW, HIGH)
SPACE = search_space()


@pytest.fixture(scope="module")
def machine(boom):
    return pack_machine(boom, 1.0, 800e6, 0.0)


@pytest.fixture(scope="module")
def simulate(boom, machine):
    """Run the loop from 6 MPa on the A-side and return pressures ``(2, T)``."""
    signals, settings = pack_signals(boom.study.controller), pack_force(boom)

    def run(reference, *, velocity=0.0, delay=0.0, filtered=False, start=6e6):
        loop = Loop(signals.sample_time, signals.ticks, delay, signals.pressure_pole, filtered)
        pressures = np.empty((2, len(reference)))
        both = start * np.array([1.0, machine.area_a / machine.area_b])
        chambers = chambers_at(machine, 0.15, velocity)
        run_force_loop(
            np.asarray(reference, float), both, chambers, loop, SUPPLIES, SPACE, settings,
            pressures,
        )  # fmt: skip
        return pressures

    return run


def orifice_flow(drop, valves):
    """Return Eq. 2's flow [m³/s], the root smoothed below 0.1 MPa; written anew."""
    size = abs(drop)
    root = math.sqrt(size) if size >= 1e5 else size * (3 - size / 1e5) / (2 * math.sqrt(1e5))
    return 2.357e-7 * valves * math.copysign(root, drop)


def exact(study, side, pressure, valves, velocity, span):
    """Solve line 1 or 2 of Eq. 1 with Eq. 4 for one chamber, written out in full."""
    cylinder, hose = study.cylinder, study.hose
    x = 0.15
    if side == 0:
        hose_volume, into = hose.volume(hose.length_a), -cylinder.area_a * velocity
        volume = cylinder.area_a * x + cylinder.dead_volume_a + hose_volume
    else:
        hose_volume, into = hose.volume(hose.length_b), cylinder.area_b * velocity
        volume = cylinder.area_b * (cylinder.stroke - x) + cylinder.dead_volume_b + hose_volume
    bulk = 1 / (1 / 800e6 + hose_volume / volume / hose.bulk_modulus)
    open_valves = valves.reshape(6, 2).sum(axis=1)

    def rate(_, p):
        flow = sum(
            orifice_flow(SUPPLIES[i] - p[0], count) for i, count in enumerate(open_valves) if count
        )
        return [bulk / volume * (flow + into)]

    solved = solve_ivp(rate, (0, span), [pressure], "LSODA", rtol=1e-10, atol=1e-3)
    return solved.y[0, -1]


@pytest.mark.parametrize("side", [0, 1])
def test_chambers_follow_an_ode_solver(boom, machine, side):
    """A full sampling period at every valve state, from random pressures and velocities."""
    settings = pack_force(boom)
    random = np.random.default_rng(side)
    worst = 0.0
    for state in range(28):
        velocity = random.uniform(-0.1, 0.1)
        chambers = chambers_at(machine, 0.15, velocity)
        start = random.uniform(4e6, 12e6)
        pressures, states = np.full(2, start), np.full(2, state)
        for _ in range(20):
            experiment._advance(pressures, states, chambers, SUPPLIES, 0.5e-3, SPACE, settings)
        wanted = exact(boom.study, side, start, SPACE.valves[state], velocity, 0.01)
        worst = max(worst, abs(pressures[side] - wanted))
    print(f"at most {worst:.2g} Pa apart")
    assert worst < 50


@pytest.mark.compiled
@pytest.mark.parametrize(("velocity", "delay"), [(0.0, 0.0), (0.1, 0.0), (-0.1, 0.0), (0.1, 0.005)])
def test_loop_repeats_the_controller_and_an_ode_solver_step_by_step(
    boom, simulate, velocity, delay
):
    """The same twelve decisions from the controller's own class, the chambers solved by scipy."""
    reference = 10e3 * np.sin(20 * 0.5e-3 * np.arange(240))
    found = simulate(reference, velocity=velocity, delay=delay)
    controller = ForceController(boom)
    pressures = found[:, 0].copy()
    held = np.zeros((2, 12))
    for period in range(12):
        np.testing.assert_allclose(found[:, 20 * period], pressures, atol=200)
        seen = Measured(0.15, velocity, *pressures, LOW, HIGH, (0.0,) * 4)
        valves = controller.step(reference[20 * period], seen, 0.0, 1.0).reshape(2, 12)
        for span, states in ((delay, held), (0.01 - delay, valves)):
            if span > 0:
                for side in range(2):
                    pressures[side] = exact(
                        boom.study, side, pressures[side], states[side], velocity, span
                    )
        held = valves


@pytest.mark.parametrize("delay", [0.0, 0.3e-3, 2e-3, 5.2e-3, 8e-3])
def test_nothing_moves_before_the_valve_delay_is_over(simulate, delay):
    pressures = simulate(np.full(40, 10e3), delay=delay)
    time = 0.5e-3 * np.arange(40)
    waiting = time <= delay + 1e-9
    assert np.all(pressures[:, waiting] == pressures[:, :1])
    assert np.all(np.abs(pressures - pressures[:, :1]).max(axis=0)[~waiting] > 1e3)


def test_a_delay_shifts_the_first_response_whatever_its_place_in_a_tick(simulate):
    """Two delays a tick apart give the same pressures a tick apart; so do 0.2 and 0.7 ms."""
    reference = np.full(20, 10e3)
    for delay in (1e-3, 1.2e-3):
        early, late = (simulate(reference, delay=delay + k * 0.5e-3) for k in range(2))
        np.testing.assert_allclose(late[:, 5:], early[:, 4:-1], rtol=1e-7)


def test_at_rest_without_force_the_valves_stay_shut(simulate):
    pressures = simulate(np.zeros(200))
    assert np.ptp(pressures, axis=1) == pytest.approx([0, 0])


def test_pressures_never_fall_below_zero(simulate):
    """A piston drawn out fast, valves late: the A-chamber cavitates and stays at its floor."""
    pressures = simulate(np.full(200, -10e3), velocity=0.1, delay=9e-3, start=1e6)
    assert pressures.min() == 0


def test_a_step_of_force_is_reached(boom, machine, simulate):
    for wanted in (-8e3, 8e3):
        a, b = simulate(np.full(400, wanted))[:, -100:]
        force = machine.area_a * a - machine.area_b * b
        assert np.abs(force - wanted).max() < 800


def test_filters_are_a_median_and_a_first_order_lag(boom):
    """The same as scipy's median and filter, started at rest."""
    signals = pack_signals(boom.study.controller)
    loop = Loop(signals.sample_time, signals.ticks, 0.0, signals.pressure_pole, True)
    samples = np.random.default_rng(0).normal(6e6, 1e6, (100, 2))
    samples[:3] = 6e6
    raw, seen = np.full((2, 2), 6e6), np.full(2, 6e6)
    found = []
    for a, b in samples:
        experiment._measure(np.array([a, b]), loop, raw, seen)
        found.append(seen.copy())
    middle = np.roll(np.stack([medfilt(one, 3) for one in samples.T]), 1, axis=1)
    middle[:, 0] = 6e6
    pole = signals.pressure_pole
    wanted = lfilter([1 - pole], [1, -pole], middle - 6e6, axis=1) + 6e6
    np.testing.assert_allclose(np.transpose(found)[:, :-1], wanted[:, :-1], rtol=1e-9)
