"""Fig. 3 simulated: against analytic sampled dynamics, Eq. 11, and every way to fail."""

import dataclasses

import numpy as np
import pytest

from mptune.errors import InputError
from mptune.force.cost import line_pressures
from mptune.force.search_space import space_of
from mptune.identify.excitation import Excitation
from mptune.identify.experiment import Loop, chambers_at, run_force_loop
from mptune.identify.identify import identify
from mptune.identify.result import BANDS, Band, FitStatus, Panel, over_points
from mptune.loops.family import time_constants_at
from mptune.loops.force_dynamics import force_dynamics
from mptune.params.pack import pack_chambers, pack_force, pack_machine

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

FEW = (
    'identification.pressures=["3 MPa", "7 MPa", "11 MPa"]',
    'identification.frequency=["8 rad/s", "180 rad/s"]',
)
ONE_PANEL = (
    *FEW,
    'identification.positions=["0.15 m"]',
    'identification.oil_bulk_moduli=["1200 MPa"]',
    "identification.frequencies=3",
)
# Valves so small that the flow through them hardly depends on the pressure within a period: what
# Eq. 11 and Eq. 12 assume.
LINEAR = (
    'identification.pressures=["5 MPa", "7 MPa"]',
    'identification.velocities=["0 m/s"]',
    'identification.positions=["0.15 m"]',
    "valves.flow_coefficient=0.5e-7 m^3/(s Pa^0.5)",
    "controller.weight_switching=0 N",
    "controller.weight_loss=0 N/J",
    "identification.amplitude=5 kN",
)


# The same for four chambers with hoses of different lengths, so that each has a lag of its own; at
# 5 kN their softer columns ask more of these valves than they pass.
FOUR_LINEAR = (
    *LINEAR,
    'identification.pressures=["4 MPa", "5 MPa"]',
    "identification.amplitude=2 kN",
    'controller.force_model="dynamic"',
    'controller.weight_compression="0 N/J"',
    'controller.delay_prediction="0 ms"',
)
HOSES = (0.3, 1.0, 2.5, 0.0)  # m


@pytest.mark.parametrize("modulus", [800e6, 1100e6, 1400e6])
def test_small_valves_make_the_loop_the_sampled_system_of_eq_12(load_boom, modulus):
    """Each period covers B/B̂ of the way, in a straight line: H = b/(z − 1 + b) · sinc²(ωT/2).

    That is Eq. 12's pole, 1 − b = e^{−T_S/τ}, yet the straight line takes another T_S/2 of time
    that Eq. 11's half sampling period leaves out: with B = B̂ the delay is T_S.
    """
    found, wanted = small_valves(load_boom(*LINEAR, *small(modulus)), modulus)
    decibels, degrees = off_by(found, wanted)
    print(np.round(decibels, 2), np.round(degrees, 1))
    assert np.abs(decibels).max() < 0.5
    assert np.abs(degrees).max() < 4


@pytest.mark.parametrize("modulus", [800e6, 1100e6])
def test_sides_of_several_chambers_have_their_mean_lag(load_shape, modulus):
    study = load_shape("four-chamber", *FOUR_LINEAR, *small(modulus))
    pairs = zip(study.study.chambers, HOSES, strict=True)
    chambers = tuple(one.model_copy(update={"hose_length": length}) for one, length in pairs)
    whole = study.study.model_copy(update={"chambers": chambers})
    found, wanted = small_valves(study.model_copy(update={"study": whole}), modulus)
    decibels, degrees = off_by(found, wanted)
    print(np.round(decibels, 2), np.round(degrees, 1))
    assert found.failed == 0
    assert found.tau_a_s > 1.05 * found.tau_b_s
    assert np.abs(decibels).max() < 0.5
    assert np.abs(degrees).max() < 4


def test_chambers_begin_side_by_side_at_no_load_and_see_the_valve_s_own_delay(load_shape):
    """Nothing moves before the delay is over; then chambers do, and reach the force."""
    study = load_shape("four-chamber")
    machine, more = pack_machine(study, 1.0, 12e8, 0.0), pack_chambers(study)
    settings, space = pack_force(study), space_of(study)
    chambers = chambers_at(machine, 0.15, 0.0, more)
    begin = np.where(chambers.areas > 0, 4e6, 8e6)
    assert chambers.areas @ begin == pytest.approx(0, abs=1e-6)
    pressures, supplies = np.empty((4, 60)), line_pressures(1e6, 12e6, space)
    loop = Loop(0.5e-3, 20, 2.2e-3, 0.8, filtered=True)
    run_force_loop(
        np.full(60, 20e3), begin, chambers, loop, supplies, space, settings, pressures, more
    )
    assert (pressures[:, :5] == begin[:, None]).all()
    assert np.abs(pressures[:, 5] - begin).max() > 1e5
    force = chambers.areas @ pressures[:, -1]
    assert force == pytest.approx(20e3, abs=3e3)  # steps of 4.4 kN


def small(modulus):
    return (
        f"identification.oil_bulk_moduli=['{modulus:g} Pa']",
        'identification.frequency=["10 rad/s", "100 rad/s"]',
        "identification.frequencies=6",
    )


def small_valves(study, modulus):
    """Return the only panel, and what sides of one lag each would make of it."""
    (panel,) = identify(study).panels
    tau_a, tau_b = time_constants_at(study, modulus, 0.15)
    share_a = study.study.share_a
    z = np.exp(1j * panel.omega * 0.01)
    wanted = 0
    # As in Eq. 11, each pressure makes the force's share of its area.
    for share, tau in ((share_a, tau_a), (1 - share_a, tau_b)):
        b = 1 - np.exp(-0.01 / tau) if tau > 0 else 1.0
        wanted = wanted + share * b / (z - 1 + b)
    return panel, wanted * np.sinc(panel.omega * 0.005 / np.pi) ** 2


def off_by(panel, wanted):
    """Return dB and degrees of the points' median over what is wanted."""
    quotient = panel.response / wanted
    middle = over_points(quotient.real, 50) + 1j * over_points(quotient.imag, 50)
    return 20 * np.log10(np.abs(middle)), np.degrees(np.angle(middle))


def test_theory_is_eq_11_with_half_a_sampling_period_and_the_valve_delay(load_boom):
    study = load_boom(*ONE_PANEL, 'identification.valve_delays=["0 ms", "5 ms"]')
    for panel in identify(study).panels:
        tau_a, tau_b = time_constants_at(study, panel.oil_bulk_modulus_pa, panel.position_m)
        s = 1j * panel.omega
        wanted = force_dynamics(s, tau_a, tau_b, study.study.share_a)
        wanted = wanted * np.exp(-s * (0.005 + panel.valve_delay_s))
        np.testing.assert_allclose(panel.theory, wanted, rtol=1e-12)


def test_panels_and_points_come_in_the_study_s_order(load_boom):
    few = identify(load_boom(*FEW, "identification.frequencies=2"))
    found = [(p.oil_bulk_modulus_pa, p.position_m, p.valve_delay_s) for p in few.panels]
    assert found == [(8e8, 0.15, 0), (8e8, 0.25, 0), (12e8, 0.15, 0), (12e8, 0.25, 0)]
    for panel in few.panels:
        assert panel.response.shape == (9, 2)
        assert panel.velocity.tolist() == [-0.1] * 3 + [0] * 3 + [0.1] * 3
        assert panel.pressure_a.tolist() == [3e6, 7e6, 11e6] * 3
        assert np.all(np.diff(panel.omega) > 0)


def test_the_same_study_gives_the_same_numbers(load_boom):
    one, other = (identify(load_boom(*ONE_PANEL)).panels[0] for _ in range(2))
    np.testing.assert_array_equal(one.response, other.response)


def test_points_with_p_b_above_p_max_are_skipped_and_counted(load_boom):
    study = load_boom(*ONE_PANEL, 'identification.pressures=["3 MPa", "12.5 MPa", "13 MPa"]')
    for panel in identify(study).panels:
        assert panel.skipped == 6
        assert set(panel.pressure_a) == {3e6}
        assert panel.json()["skipped_points"] == 6


def test_fits_with_more_residual_than_sine_are_marked_and_leave_no_response(load_boom):
    """±200 N drowns in the ripple of the valves."""
    study = load_boom(
        *ONE_PANEL,
        "identification.amplitude=200 N",
        'identification.frequency=["100 rad/s", "200 rad/s"]',
    )
    panel = identify(study).panels[0]
    assert panel.failed == panel.count(FitStatus.POOR) > 0
    assert np.all(np.isnan(panel.response) == (panel.status != FitStatus.FITTED))
    assert sum(panel.json()["fits"].values()) == panel.status.size


def test_pressures_outside_their_limits_fail_the_fit(load_boom):
    """A piston drawn out faster than the valves can fill leaves the A-chamber empty."""
    study = load_boom(*ONE_PANEL, 'identification.velocities=["0 m/s", "0.6 m/s"]')
    panel = identify(study).panels[0]
    fast = panel.velocity == 0.6
    assert np.all(panel.status[fast] == FitStatus.OUT_OF_RANGE)
    assert np.all(panel.status[~fast] == FitStatus.FITTED)
    assert np.all(np.isnan(panel.response[fast]))


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ('identification.positions=["0.31 m"]', "beyond the stroke"),
        ('identification.valve_delays=["10 ms"]', "sampling period"),
        ('identification.frequency=["1 rad/s", "320 rad/s"]', "half the sampling frequency"),
        ('identification.oil_bulk_moduli=["1.5 GPa"]', "above the estimate"),
        ('identification.pressures=["15 MPa"]', "no operating point"),
    ],
)
def test_operating_points_that_do_not_fit_are_refused(load_boom, override, words):
    with pytest.raises(InputError, match=words) as refused:
        identify(load_boom(override))
    (fault,) = refused.value.faults
    assert fault.key == override.split("=")[0]


def test_every_fault_is_named_at_once(load_boom):
    study = load_boom(
        'identification.positions=["0.31 m"]', 'identification.valve_delays=["10 ms"]'
    )
    with pytest.raises(InputError) as refused:
        identify(study)
    assert len(refused.value.faults) == 2


def panel_of(response):
    """Return a panel whose theory is 1 at two frequencies, with given responses ``(N, 2)``."""
    response = np.array(response, complex)
    fitted = np.isfinite(response)
    return Panel(
        position_m=0.15, oil_bulk_modulus_pa=8e8, valve_delay_s=0.0, tau_a_s=0.0, tau_b_s=0.0,
        omega=np.array([10.0, 100.0]), velocity=np.zeros(len(response)),
        pressure_a=np.zeros(len(response)), skipped=0, response=response,
        quality=np.ones(response.shape), status=np.where(fitted, 0, 1), theory=np.ones(2, complex),
    )  # fmt: skip


def test_agreement_counts_what_is_fitted_and_keeps_signs():
    off = 10 ** (-1 / 20) * np.exp(1j * np.radians(9))  # 1 dB low, 9° ahead
    panel = panel_of([[1, 1], [1, 1], [1, np.nan], [off, off]])
    low, high = (panel.agreement(band) for band in BANDS)
    assert low.within == 0.75
    assert not low.satisfied  # three points of four are not most
    assert low.median_decibels == pytest.approx(0)
    assert low.largest_decibels == pytest.approx(-1)
    assert low.largest_degrees == pytest.approx(9)
    assert high.within == 1  # ±2 dB and ±15°
    assert panel.failed == 1
    assert not panel_of([[1, 1], [off, off]]).satisfied


def test_a_frequency_moved_off_a_band_s_edge_still_counts():
    panel = panel_of([[1, 1]])
    edges = np.array([40.05, 200.2])
    moved = dataclasses.replace(panel, omega=edges)
    assert moved.agreement(BANDS[0]) is not None
    assert moved.agreement(BANDS[1]) is not None


def test_a_band_without_fits_has_no_agreement_and_nothing_agrees():
    panel = panel_of([[np.nan, np.nan]])
    assert panel.agreement(BANDS[0]) is None
    assert panel.agreement(Band(200, 300, 1, 1)) is None
    assert not panel.satisfied
    assert panel.json()["agreement"] == [None, None]


@pytest.mark.parametrize("excitation", [Excitation.MULTISINE, Excitation.CHIRP])
def test_other_excitations_find_the_sine_fit_s_response_where_the_loop_is_linear(
    load_boom, excitation
):
    overrides = (
        *LINEAR,
        'identification.oil_bulk_moduli=["1200 MPa"]',
        'identification.frequency=["4 rad/s", "120 rad/s"]',
        "identification.frequencies=10",
    )
    study = load_boom(*overrides)
    (sine,) = identify(study).panels
    (other,) = identify(study, excitation).panels
    inside = (other.omega > 8) & (other.omega < 110)
    found = np.nanmean(other.response, axis=0)[inside]
    wanted = np.nanmean(sine.response, axis=0)
    angle = np.unwrap(np.angle(wanted))
    magnitude = np.interp(other.omega[inside], sine.omega, np.abs(wanted))
    phase = np.interp(other.omega[inside], sine.omega, angle)
    quotient = found / (magnitude * np.exp(1j * phase))
    decibels, degrees = 20 * np.log10(np.abs(quotient)), np.degrees(np.angle(quotient))
    print(f"median {np.median(np.abs(decibels)):.2f} dB, {np.median(np.abs(degrees)):.1f}°; ")
    print(f"at most {np.abs(decibels).max():.2f} dB, {np.abs(degrees).max():.1f}°")
    assert np.median(np.abs(decibels)) < 0.5
    assert np.median(np.abs(degrees)) < 3
