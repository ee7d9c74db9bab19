"""§7's figures of made-up movement sets, by hand: of this machine's trace, and of any load."""

import numpy as np
import pytest

from mptune.params.pack import pack_machine
from mptune.sim import closed_loop as loop
from mptune.sim.judge import longest_oscillation, per_year, set_figures, worst_per_mass
from mptune.sim.machine_record import broken_limits, record_of
from mptune.sim.moves import Moves
from mptune.sim.record import Energies, RunRecord

TICK = 5e-4
# 50 mm out and back, 0.6 s each with rests of 0.4 s.
MOVES = Moves(np.empty((0, 7)), ends=np.array([1.0, 2.0]), travel=0.1)


@pytest.fixture(scope="module")
def machine(boom):
    return pack_machine(boom, 24500.0, 1.2e9, 9700.0)


@pytest.fixture
def trace(machine):
    """Two seconds at mid-stroke, 1 mm behind the reference but for the ends of both rests."""
    rows = np.zeros((4000, loop.CONVERTER_1 + 4))
    rows[:, loop.POSITION], rows[:, loop.X_REF] = 0.15, 0.151
    rows[[1999, 3999], loop.X_REF] = 0.1503, 0.1496
    rows[:, loop.VELOCITY] = 0.1
    rows[:, loop.CHAMBER_A], rows[:, loop.CHAMBER_B] = 6e6, 5e6
    rows[:, loop.ACTIVE], rows[:, loop.HIGH_PRESSURE] = 1, 14e6
    force = 6e6 * machine.area_a - 5e6 * machine.area_b
    rows[:, loop.F_REF] = force + 2000.0
    return rows


def test_the_busiest_valve_is_counted_per_second_and_per_year(trace, machine):
    record = record_of(trace, MOVES, np.zeros(8), 12, machine, TICK, (-5e4, 9e4), busiest=7)
    assert set_figures(record).busiest_valve_per_s == pytest.approx(3.5)  # in two seconds
    assert np.isnan(figures(trace, machine).busiest_valve_per_s)  # not counted
    assert per_year(3.5, 0.2) == pytest.approx(3.5 * 0.2 * 31_557_600)


def figures(trace, machine, energy=None, limits=(-5e4, 9e4)):
    energy = np.zeros(8) if energy is None else energy
    return set_figures(record_of(trace, MOVES, energy, 12, machine, TICK, limits))


def test_tracking_figures(trace, machine):
    found = figures(trace, machine)
    assert found.performance_index_ms == pytest.approx(10.0)  # 1 mm at 100 mm/s
    assert found.final_error_mm == pytest.approx(0.4)
    assert found.peak_velocity_mm_s == pytest.approx(100)
    assert found.force_error_integral_kn2s == pytest.approx(8.0)  # (2 kN)² for 2 s
    assert (found.pressure_min_mpa, found.pressure_max_mpa) == pytest.approx((5, 6))
    assert found.valve_switches == 12


def test_force_error_counts_only_while_the_controller_is_active(trace, machine):
    trace[1000:, loop.ACTIVE] = 0
    assert figures(trace, machine).force_error_integral_kn2s == pytest.approx(2.0)


def test_loss_is_supply_less_piston_work_per_travel(trace, machine):
    #                  pump, acc, tank, piston, throttling, converters, compression, relief
    energy = np.array([3000, 2500, -300, 500, 1500, 150, 50, 0], float)
    found = figures(trace, machine, energy)
    assert found.energy_loss_j_per_mm == pytest.approx((2500 - 500) / 100)
    assert found.pump_loss_j_per_mm == pytest.approx((3000 - 500) / 100)
    assert found.energy_residual == pytest.approx(0, abs=1e-12)
    energy[5] += 220
    assert figures(trace, machine, energy).energy_residual == pytest.approx(0.1)


def test_time_at_a_force_limit_is_counted(trace, machine):
    limits = (-5e4, trace[0, loop.F_REF])
    trace[400:, loop.F_REF] -= 1.0
    assert figures(trace, machine, limits=limits).saturated_s == pytest.approx(0.2)


@pytest.mark.parametrize(("frequency", "counts"), [(10.0, True), (1.0, False)])
def test_fast_swings_are_an_oscillation_and_slow_ones_are_not(frequency, counts):
    """Both reach half the peak reference velocity; swings 0.25 s apart do not count."""
    time = np.arange(4000) * TICK
    wanted = np.full(len(time), 0.1)
    found = longest_oscillation(wanted + 0.05 * np.sin(2 * np.pi * frequency * time), wanted, TICK)
    print(f"{frequency:g} Hz for 2 s: {found} swings")
    assert found == (40 if counts else pytest.approx(0, abs=4))


def test_small_swings_are_no_oscillation():
    wanted = np.full(4000, 0.1)
    swings = 0.019 * np.sin(2 * np.pi * 10 * np.arange(4000) * TICK)
    assert longest_oscillation(wanted + swings, wanted, TICK) == 0


def test_broken_limits_are_named_in_the_order_of_time(trace, machine):
    assert broken_limits(trace, machine, TICK, 9.0) == ()
    trace[3000, loop.POSITION] = machine.stroke
    trace[2000, loop.CONVERTER_1 + 3] = -machine.converter_travel
    first, second = broken_limits(trace, machine, TICK, 9.0)
    assert ("converter" in first.name, "the piston" in second.name) == (True, True)
    assert (first.at, second.at) == pytest.approx((10.0, 10.5))
    trace[1000, loop.HIGH_PRESSURE] = machine.accumulator_precharge
    first, *others = broken_limits(trace, machine, TICK, 9.0)
    assert "accumulator" in first.name
    assert first.at == pytest.approx(9.5)
    assert len(others) == 2


def servo(**changes):
    """One second of a load under something that has neither chambers nor converters."""
    still = np.zeros(1000)
    plain = {
        "sample_time": 1e-3,
        "position_reference": still + 0.002,
        "velocity_reference": still + 0.1,
        "position": still,
        "velocity": still + 0.05,
        "force_reference": still + 3e3,
        "force": still,
        "active": still == 0,
        "ends": np.array([1.0]),
        "travel": 0.05,
        "energies": Energies(900.0, 700.0, -50.0, 100.0, {"valve": 500.0, "leakage": 50.0}),
    }
    return RunRecord(**{**plain, **changes})


def test_a_load_is_judged_whatever_moves_it():
    found = set_figures(servo())
    assert found.performance_index_ms == pytest.approx(40)  # 2 mm at 50 mm/s
    assert found.energy_loss_j_per_mm == pytest.approx((700 - 100) / 50)
    assert found.pump_loss_j_per_mm == pytest.approx((900 - 100) / 50)
    assert found.energy_residual == pytest.approx(0)
    assert found.force_error_integral_kn2s == pytest.approx(9)
    assert found.valve_switches == 0
    assert np.isnan([found.converter_peak_mm, found.pressure_min_mpa, found.pressure_max_mpa]).all()
    assert found.saturated_s == 0  # without limits there is nothing to be at


def test_a_record_s_arrays_are_read_only_and_the_caller_s_are_not():
    mine = np.zeros(1000)
    record = servo(position=mine)
    with pytest.raises(ValueError, match="read-only"):
        record.position[0] = 1.0
    mine[0] = 1.0
    assert record.time[-1] == pytest.approx(0.999)


class Run:
    def __init__(self, mass_kg, badness):
        self.mass_kg, self.badness = mass_kg, badness


def test_the_worst_of_each_mass_is_the_first_unstable_run_or_the_largest_index():
    runs = [Run(1, 3.0), Run(2, 5.0), Run(1, 4.0), Run(2, np.inf), Run(2, np.inf)]
    assert worst_per_mass(runs) == (runs[2], runs[3])
