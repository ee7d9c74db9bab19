"""Margins of single plants against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.loops.broken import FORCE, VELOCITY
from mptune.loops.family import FamilyLoops
from mptune.params.packed import NO_PATH, LoopGains, MeasurementPath, NominalPlant, Plants
from mptune.robust.grid import first_grid, frequency_range
from mptune.robust.margins import family_margins

SHARE_A = 4 / 7
GRID = np.geomspace(0.01, 3000, 300)
GAINS = LoopGains(700e3, 13.0, 22.0, 42.0, 0.55, 0.006)


def margins_of(mass, delay, tau=0.0, gains=GAINS, omega=GRID):
    plants = Plants(*(np.array([value]) for value in (mass, delay, tau, tau, SHARE_A)))
    return family_margins(omega, FamilyLoops(plants, gains, NO_PATH))


def figure(margins, name, loop=VELOCITY):
    return float(getattr(margins, name)[loop, 0])


def test_an_integrator_with_dead_time_has_its_known_margins():
    crossover = 700e3 / 24500
    margins = margins_of(24500.0, 0.011)
    limit = np.pi / (2 * 0.011)
    assert figure(margins, "gain_margin") == pytest.approx(limit / crossover, rel=1e-9)
    assert figure(margins, "gain_frequency") == pytest.approx(limit, rel=1e-9)
    phase = np.pi / 2 - crossover * 0.011
    assert figure(margins, "phase_margin") == pytest.approx(phase, rel=1e-9)
    assert figure(margins, "phase_frequency") == pytest.approx(crossover, rel=1e-9)
    assert figure(margins, "delay_margin") == pytest.approx(phase / crossover, rel=1e-9)
    assert figure(margins, "gain_reduction") == 0
    assert np.isnan(figure(margins, "reduction_frequency"))


def test_the_compliance_is_the_whole_loop_s():
    """Of a P controller and an undelayed machine it is greatest at rest: 1/(K_P,vel K_P,pos)."""
    gains = GAINS._replace(k_i_pos=0.0, omega=1 / GAINS.tau, xi=1.0)  # G_P = K_P,pos
    margins = margins_of(24500.0, 0.0, gains=gains)
    found = figure(margins, "peak_compliance", FORCE)
    assert found == pytest.approx(1 / (700e3 * 13.0), rel=1e-5)
    assert np.isnan(figure(margins, "peak_compliance"))


def test_an_integrator_with_a_lag_alone_has_endless_gain_margin():
    margins = margins_of(24500.0, 0.0, 0.01)
    assert figure(margins, "gain_margin") == np.inf
    assert np.isnan(figure(margins, "gain_frequency"))


def test_an_integrator_with_a_lag_is_a_second_order_system():
    # T = 1/(τ/ω_c s² + s/ω_c + 1): ζ = 1/(2√(τ ω_c)) and M_T = 1/(2ζ√(1 − ζ²))
    crossover, tau = 700e3 / 24500, 0.05
    damping = 0.5 / np.sqrt(tau * crossover)
    margins = margins_of(24500.0, 0.0, tau)
    peak = 1 / (2 * damping * np.sqrt(1 - damping**2))
    assert figure(margins, "complementary_peak") == pytest.approx(peak, rel=1e-9)
    natural = np.sqrt(crossover / tau)
    at = natural * np.sqrt(1 - 2 * damping**2)
    assert figure(margins, "complementary_frequency") == pytest.approx(at, rel=1e-5)


@pytest.mark.parametrize("points", [60, 120, 1000])
def test_figures_do_not_hang_on_the_grid(points):
    coarse = margins_of(24500.0, 0.014, 0.012, omega=np.geomspace(0.01, 3000, points))
    fine = margins_of(24500.0, 0.014, 0.012, omega=np.geomspace(0.01, 3000, 20000))
    for name in coarse._fields:
        if "frequency" not in name:
            np.testing.assert_allclose(getattr(coarse, name), getattr(fine, name), rtol=1e-8)


def test_with_an_integral_term_too_little_gain_is_unstable_too():
    # without lag or delay m s³ + K (s² + K_P s + K_I) is stable for K > m K_I/K_P
    gains = LoopGains(700e3, 13.0, 22.0, 1e6, 0.0, 1e-6)
    omega = np.geomspace(0.01, 300, 400)
    margins = margins_of(24500.0, 0.0, gains=gains, omega=omega)
    reduction = 24500 * 22 / 13 / 700e3
    assert figure(margins, "gain_reduction", FORCE) == pytest.approx(reduction, rel=1e-3)


def test_the_delay_margin_is_the_least_over_all_crossovers_and_not_that_of_the_phase_margin():
    # A light damping of Eq. 22's numerator and a strong gain make several crossovers.
    gains = LoopGains(900e3, 60.0, 0.0, 30.0, 0.05, 0.002)
    omega = np.geomspace(0.1, 3000, 4000)
    margins = margins_of(24500.0, 0.002, gains=gains, omega=omega)
    plain = figure(margins, "phase_margin", FORCE) / figure(margins, "phase_frequency", FORCE)
    assert figure(margins, "delay_margin", FORCE) <= plain * (1 + 1e-12)


def test_the_disk_margin_of_an_integrator_is_full():
    # |(1 − L)/(1 + L)| = 1 on the whole axis for L = ω_c/s: α = 2
    margins = margins_of(24500.0, 0.0)
    assert figure(margins, "disk_margin") == pytest.approx(2, rel=1e-9)


def test_each_plant_has_its_own_row_and_column():
    pairs = ((24500.0, 49000.0), (0.011,) * 2, (0.0,) * 2, (0.0,) * 2, (SHARE_A,) * 2)
    plants = Plants(*(np.array(pair) for pair in pairs))
    both = family_margins(GRID, FamilyLoops(plants, GAINS, NO_PATH))
    for index, mass in enumerate((24500.0, 49000.0)):
        alone = margins_of(mass, 0.011)
        for name in both._fields:
            np.testing.assert_array_equal(getattr(both, name)[:, index], getattr(alone, name)[:, 0])


def grid_of(plant, gains):
    """Return the first grid of a sweep, on which margins are looked for."""
    plants = Plants(*(np.array([value]) for value in (*plant, SHARE_A)))
    nominal = NominalPlant(plant[0], plant[1])
    return plants, first_grid(*frequency_range(plants, nominal, gains))


# Well damped loops with two peaks of about the same height, the higher one between grid points.
TWO_PEAKS = [
    (
        LoopGains(1478058.5, 1.4186197, 57.514607, 159.94206, 1.0959395, 0.024397602),
        (19694.548, 0.0051998228, 5.0093897e-05, 0.006880777),
        NO_PATH,
    ),
    (
        LoopGains(1122348.6, 1.5543985, 61.521339, 71.381598, 0.42946586, 0.014015845),
        (22623.906, 0.0092275257, 0.01413633, 0.0073945964),
        MeasurementPath(0.0005, float(np.exp(-0.0005 / 0.012)), 0.012),
    ),
]


@pytest.mark.parametrize(("gains", "plant", "path"), TWO_PEAKS, ids=["no path", "filters"])
def test_the_higher_of_two_peaks_is_found_though_the_grid_shows_it_lower(gains, plant, path):
    plants, omega = grid_of(plant, gains)
    dense = np.geomspace(omega[0], omega[-1], 100 * len(omega))
    loops = FamilyLoops(plants, gains, path)
    coarse, fine = (family_margins(w, loops) for w in (omega, dense))
    names = ("sensitivity_peak", "complementary_peak", "disk_margin")
    for name in names:
        found, expected = getattr(coarse, name)[:, 0], getattr(fine, name)[:, 0]
        print(f"{name}: {found} on the sweep's grid, {expected} on one 100 times denser")
    for name in names:
        np.testing.assert_allclose(getattr(coarse, name), getattr(fine, name), rtol=1e-4)


def test_a_gain_margin_beyond_the_grid_s_end_is_not_called_endless():
    gains = LoopGains(404549.67, 15.110692, 59.322662, 87.612391, 1.3939068, 0.023977577)
    plants, omega = grid_of((51765.619, 0.0012410238, 0.0094302377, 0.0019866358), gains)
    loops = FamilyLoops(plants, gains, NO_PATH)
    margins = family_margins(omega, loops)
    wide = family_margins(np.geomspace(omega[0], 1e5, 20000), loops)
    print(
        f"gain margin: {margins.gain_margin[0, 0]} on the grid, {wide.gain_margin[0, 0]:.1f} wide"
    )
    np.testing.assert_allclose(margins.gain_margin, wide.gain_margin, rtol=1e-6)
