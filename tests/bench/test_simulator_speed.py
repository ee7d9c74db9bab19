"""How fast the nonlinear machine and its force controller are, and that they keep their memory.

One core; run with ``make bench``.
"""

import resource
import time

import numba
import numpy as np
import pytest
from llvmlite.binding import get_host_cpu_features
from opened import opened
from scipy.integrate import solve_ivp

from mptune.force.cost import supply_pressures
from mptune.force.search_space import search_space, space_of
from mptune.force.select import decide
from mptune.params.load import load_study
from mptune.params.pack import pack_force, pack_gains, pack_machine
from mptune.params.packed import NO_TABLE
from mptune.plant import machine as plant
from mptune.plant.piston import burden_at
from mptune.plant.valve import open_valves
from mptune.sim.integrator import integrate as advance
from mptune.sim.integrator import new_work
from mptune.verify.verify import cases_of, new_memory, run_case

pytestmark = pytest.mark.bench

STATES = plant.CONVERTER + 4  # of the paper's machine
TICK = 5e-4  # s
SET = 9.0  # s of simulated time in one movement set
SETS = 200


@pytest.fixture(scope="module")
def run(study_file):
    def runs(repeats):
        asked = f"verification.repeats={repeats}"
        study = load_study(study_file, ['verification.masses=["24.5 t"]', asked])
        return run_case(study, cases_of(study)[0], study.study.gains, study.study.feedforward)

    runs(1)  # compile, or load from the cache
    return runs


def seconds(function):
    start = time.perf_counter()
    function()
    return time.perf_counter() - start


def cpu_seconds(function):
    """For comparisons: what else the machine does meanwhile does not count."""
    start = time.process_time()
    function()
    return time.process_time() - start


def test_a_decision_takes_at_most_12_microseconds(boom):
    settings, space = pack_force(boom), search_space()
    supplies, converters = supply_pressures(2e6, 14e6), np.array([0.01, -0.02, 0.03, 0.0])
    random = np.random.default_rng(1)
    pressures = random.uniform(2e6, 14e6, (2000, 2))

    def batch():
        states = 0, 0
        for p_a, p_b in pressures:
            states = decide(
                2e4, p_a, p_b, 0.15, 0.05, supplies, converters, *states, space, settings
            )

    batch()
    times = [seconds(batch) / len(pressures) for _ in range(7)]
    print(f"\none decision: {1e6 * np.median(times):.1f} µs, called from Python")
    assert np.median(times) <= 12e-6


LEVERS = (
    'controller.error="huber"',
    'controller.loss="path"',
    "controller.horizon=2",
    'controller.delay_prediction="6.25 ms"',
)
WIDE = bool(get_host_cpu_features().get("avx2"))


@pytest.mark.guard
def test_two_periods_take_at_most_twice_the_published_decision(load_boom, ratio):
    """In one run, over the same random states, called from compiled code, in turn."""
    space, random = search_space(), np.random.default_rng(1)
    supplies, converters = supply_pressures(2e6, 14e6), np.array([0.01, -0.02, 0.03, 0.0])
    pressures = random.uniform(2e6, 14e6, (2000, 2))
    wanted = random.uniform(-3e4, 5e4, 2000)
    options = {
        "published": (),
        "Huber": LEVERS[:1],
        "two periods": ("controller.horizon=2",),
        "all levers": (*LEVERS[:3], 'controller.weight_common_mode="300 N/MPa"'),
        "steady state": ('controller.force_model="steady-state"',),
    }
    packed = {name: pack_force(load_boom(*one)) for name, one in options.items()}
    times = {name: [] for name in options}
    for _ in range(15):
        for name, settings in packed.items():
            args = wanted, pressures, supplies, converters, space, settings
            decisions(*args)
            times[name].append(cpu_seconds(lambda args=args: decisions(*args)) / len(pressures))
    medians = {name: float(np.median(one)) for name, one in times.items()}
    print("\n" + ", ".join(f"{name} {1e6 * one:.2f} µs" for name, one in medians.items()))
    most = 2 if WIDE else 4
    for name in ("two periods", "all levers"):
        cost = medians[name] / medians["published"]
        ratio(f"decision, {name}: over the published one", cost, most=most)


@numba.njit
def decisions(wanted, pressures, supplies, converters, space, settings):
    """Decide again and again, from each choice."""
    a, b = 0, 0
    for k in range(len(wanted)):
        a, b = decide(
            wanted[k], pressures[k, 0], pressures[k, 1], 0.15, 0.05, supplies, converters, a, b,
            space, settings,
        )  # fmt: skip
    return a + b


@pytest.mark.guard
def test_all_levers_cost_at_most_a_tenth_of_the_closed_loop_s_speed(study_file, ratio):
    """Fewer switches mean fewer fine steps."""
    base = ["verification.repeats=1", 'verification.masses=["24.5 t"]']
    studies = [load_study(study_file, [*base, *levers]) for levers in ((), LEVERS)]
    times = [[], []]
    for _ in range(16):
        for study, taken in zip(studies, times, strict=True):
            own = study.study
            taken.append(
                cpu_seconds(
                    lambda study=study, own=own: run_case(
                        study, cases_of(study)[0], own.gains, own.feedforward
                    )
                )
            )
    published, levers = (SET / float(np.median(one[1:])) for one in times)
    print(f"\npublished {published:.0f} x real time, all levers {levers:.0f} x")
    ratio("closed loop, all levers: speed over published", levers / published, least=0.9)


def test_closed_loop_runs_at_150_times_real_time(run):
    times = [seconds(lambda: run(1)) for _ in range(15)]
    factor = SET / float(np.median(times))
    print(f"\none set of {SET:g} s: {1e3 * np.median(times):.1f} ms, {factor:.0f} x real time")
    assert factor >= 150


@numba.njit
def integrate(memory, machine, space, ticks):
    work = new_work(memory.valves, space.lines, space.edge, len(memory.state))
    for tick in range(ticks):
        advance(
            memory.state, memory.energy, memory.valves, 0.0,
            machine, NO_TABLE, 2e-3, tick * TICK, TICK, work,
        )  # fmt: skip


@pytest.mark.guard
@pytest.mark.parametrize("method", ["LSODA", "RK45"])
def test_integration_is_at_least_3_times_faster_than_scipy_with_the_same_compiled_rates(
    boom, method, ratio
):
    """The same compiled rates from ten states, 10 ms each: the time between two decisions."""
    machine, space = pack_machine(boom, 24500.0, 1.2e9, 9700.0), space_of(boom)
    random, span = np.random.default_rng(3), 0.01
    scale = np.array([1, 1, 1e6, 1e6, 1e-3, 1, 1, 1, 1])
    power, lines = np.empty(plant.ENERGIES), opened(space.lines, 0.0, 0.0)

    def slope(_, y):
        rate = np.empty(STATES)
        plant.rates(y * scale, lines, 0.0, machine, burden_at(y[0], machine, NO_TABLE), rate, power)
        return rate / scale

    fast = slow = deviation = 0.0
    for _ in range(10):
        memory = new_memory(boom, machine, pack_gains(boom.study.gains), 0.15)
        memory.state[1:4] = random.uniform([-0.1, 4e6, 4e6], [0.1, 12e6, 12e6])
        opening = [space.valves[state] for state in random.integers(1, 28, 2)]
        for array in (memory.valves.opening, memory.valves.target, memory.valves.commanded):
            array[:] = np.concatenate(opening)
        open_valves(memory.valves, space.edge, space.lines, lines)
        start, times = memory.state[:STATES].copy(), []
        for _ in range(9):
            memory.state[:STATES] = start
            times.append(seconds(lambda memory=memory: integrate(memory, machine, space, 20)))
        fast += float(np.median(times))
        solved = []
        slow += seconds(
            lambda start=start, solved=solved: solved.append(
                solve_ivp(slope, (0, span), start / scale, method, rtol=1e-6, atol=1e-8)
            )
        )
        assert solved[0].success
        exact = solved[0].y[:, -1] * scale
        deviation = max(deviation, np.abs(memory.state[2:4] - exact[2:4]).max())
    print(
        f"\n{10 * span:g} s: {method} {1e3 * slow:.1f} ms, mptune {1e3 * fast:.2f} ms, "
        f"{slow / fast:.0f} times faster; pressures at most {deviation:.0f} Pa apart"
    )
    ratio(f"integration of 10 ms: SciPy's {method} over mptune", slow / fast, least=3)


def test_memory_stays_flat_over_half_an_hour_of_simulated_time(run):
    """200 movement sets; the high-water mark of the process after the first 20 must hold."""
    run(20)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    start = time.perf_counter()
    case = run(SETS)
    elapsed = time.perf_counter() - start
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    print(
        f"\n{SETS} sets in {elapsed:.1f} s, {SETS * SET / elapsed:.0f} x real time; "
        f"{case.status}, memory +{grown:.1f} MiB"
    )
    assert len(case.sets) == SETS - 1
    assert np.isfinite(case.traces).all()
    assert grown < 10
