"""Designing a loop of one's own, from Python."""

import control
import numpy as np
import pytest

from mptune.certify.result import Grounds
from mptune.errors import InputError
from mptune.shape import certificate, structure
from mptune.shape.design import design
from mptune.shape.problem import Function, Peak
from mptune.shape.procedure import ShapeStatus
from mptune.shape.rational import RationalPlant

OMEGA = np.geomspace(1e-3, 30, 300)
S = control.tf("s")
LAG = 1 / (S + 1) ** 3


def lag(s):
    return 1 / (s + 1) ** 3


FORMS = {
    "function": (lag, None),
    "transfer function": (LAG, None),
    "state space": (control.ss(LAG), None),
    "array": (lag(1j * OMEGA), OMEGA),
    "frequency response": (control.frd(LAG, OMEGA), None),
    "poles and zeros": (RationalPlant([], [-1.0] * 3, 1.0), None),
}
KNOWN = {"transfer function", "state space", "poles and zeros"}  # that know their poles


@pytest.mark.parametrize("form", FORMS)
def test_every_form_of_one_plant_gives_the_same_controller(form):
    plant, omega = FORMS[form]
    found = design(plant, structure.pi(), omega, maximise="k_i", sensitivity_peak=1.4)
    print(form, found.gains, found.verdicts)
    assert found.shaped.status is ShapeStatus.OPTIMAL
    assert found.gains["k_i"] == pytest.approx(0.3253, rel=2e-3)
    (verdict,) = found.verdicts
    assert verdict.attained == pytest.approx(1.4, abs=1e-4)
    if form in KNOWN:
        assert found.stability is verdict.grounds is Grounds.CERTIFIED
        assert verdict.attained <= verdict.bound <= 1.4
    else:
        assert found.stability is verdict.grounds is Grounds.GRID
        assert np.isnan(verdict.bound)
        assert verdict.kept


def test_poles_are_read_from_objects_that_know_them():
    """An unstable plant: without its pole's count no controller would be called stable."""
    found = design(
        1 / (S - 1), structure.pi(), maximise="k_i", sensitivity_peak=1.6, high={"k_p": 20}
    )
    closed = np.roots([1, found.gains["k_p"] - 1, found.gains["k_i"]])
    assert found.shaped.status is ShapeStatus.OPTIMAL
    assert np.all(closed.real < 0)


def test_family_of_mixed_forms_keeps_m_s_on_every_plant():
    family = [0.7 * LAG, lambda s: 1.3 / (s + 1) ** 3, control.ss(1 / (1.3 * S + 1) ** 3)]
    found = design(LAG, structure.pid(0.05), maximise="k_i", sensitivity_peak=1.6, family=family)
    controller = found.structure.controller(np.array([*found.gains.values()]), OMEGA)
    peaks = [
        np.abs(1 / (1 + np.asarray(plant(1j * OMEGA)) * controller)).max()
        for plant in (LAG, *family)
    ]
    print(found.gains, peaks)
    assert found.shaped.status is ShapeStatus.OPTIMAL
    assert max(peaks) <= 1.6 * (1 + 1e-6)
    assert max(peaks) == pytest.approx(1.6, rel=1e-3)


def test_ratio_is_eq_17_for_any_family():
    family = [0.6 * LAG, 1.4 * LAG, LAG * (1 / (0.3 * S + 1))]
    found = design(LAG, structure.pi(), maximise="k_i", ratio=0.5, family=family)
    s = 1j * OMEGA
    loop = lag(s) * found.structure.controller(np.array([*found.gains.values()]), OMEGA)
    left = np.max([np.abs(np.asarray(plant(s)) / lag(s) - 1) for plant in family], axis=0)
    worst = (left / np.abs((1 + loop) / loop)).max()
    print(f"largest left/right ratio {worst:.5f}")
    assert worst == pytest.approx(0.5, rel=1e-3)
    assert worst <= 0.5 * (1 + 1e-6)
    (verdict,) = found.verdicts
    assert verdict.grounds is Grounds.CERTIFIED
    assert worst <= verdict.bound <= 0.5
    assert worst == pytest.approx(verdict.attained, rel=1e-3)  # between 300 frequencies


def test_weighted_sensitivity_falls_with_more_freedom():
    weight = {"sensitivity_weight": lambda omega: 0.5 / omega, "sensitivity_peak": 1.5}
    less = design(LAG, structure.pi(), **weight).shaped.objective
    more = design(LAG, structure.pid(0.05), **weight).shaped.objective
    print(f"max w|S|: PI {less:.4f}, PID {more:.4f}")
    assert more < 0.9 * less


def test_bounds_by_name_are_kept():
    found = design(LAG, structure.pi(), maximise="k_i", sensitivity_peak=1.4, high={"k_p": 0.3})
    assert found.gains["k_p"] <= 0.3 * (1 + 1e-6)
    assert found.gains["k_i"] < 0.32


BAD = {
    "array without frequencies": ({"plant": lag(1j * OMEGA)}, "give omega"),
    "lengths differ": ({"plant": lag(1j * OMEGA), "omega": OMEGA[:-1]}, "one value per frequency"),
    "frequencies fall": ({"plant": lag(1j * OMEGA), "omega": OMEGA[::-1]}, "do not rise"),
    "not finite": ({"plant": lag(1j * OMEGA) * np.nan, "omega": OMEGA}, "not finite"),
    "sampled time": ({"plant": control.tf([1], [1, -0.5], 0.1)}, "sampled time"),
    "no objective": ({"maximise": None}, "not exactly one"),
    "two objectives": ({"sensitivity_weight": 1.0}, "not exactly one"),
    "unknown parameter": ({"maximise": "k_d"}, "one of k_p, k_i"),
    "unknown bound": ({"high": {"k_d": 1}}, "one of k_p, k_i"),
    "bounds crossed": ({"low": {"k_p": 2}, "high": {"k_p": 1}}, "above its upper bound"),
    "ratio without family": ({"ratio": 0.5}, "needs a family"),
    "other frequencies": (
        {"plant": control.frd(LAG, OMEGA), "family": [control.frd(LAG, OMEGA[:-1])]},
        "other frequencies",
    ),
    "no frequency of its own": ({"plant": lambda s: 1 / s**2}, "phase stays the same"),
    "grid too short": ({"plant": lag(1j * OMEGA[:50]), "omega": OMEGA[:50]}, "frequencies, or"),
    "start incomplete": ({"start": {"k_p": 1.0}}, "k_i"),
    "contradicted count": ({"plant": LAG, "integrators": 1}, "has 0 by its own poles"),
    "frequency of a pole": (
        {"plant": RationalPlant([], [3j, -3j, -1], 1.0), "omega": np.linspace(1, 5, 201)},
        "not finite",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_refused_with_a_remedy(case):
    changes, message = BAD[case]
    options = {"plant": lag, "structure": structure.pi(), "maximise": "k_i"} | changes
    with pytest.raises(InputError, match=message):
        design(**options, sensitivity_peak=1.4)


def test_the_grid_is_widened_to_where_the_tuned_loop_acts():
    """A lead-compensated lag crosses over far above the plant's own range."""
    found = design(
        1 / (S + 1) ** 2,
        structure.pid(1e-3),
        maximise="k_i",
        sensitivity_peak=1.4,
        high={"k_d": 100},
    )
    omega = np.geomspace(1e-3, 1e6, 200_000)
    loop = np.asarray((1 / (S + 1) ** 2)(1j * omega)) * found.structure.controller(
        np.array([*found.gains.values()]), omega
    )
    peak = np.abs(1 / (1 + loop)).max()
    print(found.gains, f"M_S {peak:.5f}, grid to {found.omega[-1]:.0f} rad/s")
    assert peak <= 1.4 * (1 + 1e-5)


def test_a_family_with_one_mere_function_is_certified_as_far_as_it_goes():
    family = [0.7 * LAG, lambda s: 1.3 / (s + 1) ** 3]
    found = design(LAG, structure.pi(), maximise="k_i", sensitivity_peak=1.6, family=family)
    nominal, others = found.verdicts
    assert nominal.grounds is Grounds.CERTIFIED
    assert others.grounds is found.stability is Grounds.GRID
    assert others.plant == 1


def test_dead_time_beside_a_transfer_function():
    """The known optimum of e^{−s}/(s + 1), certified."""
    plant = RationalPlant.of(1 / (S + 1), delay=1.0)
    found = design(plant, structure.pi(), maximise="k_i", sensitivity_peak=1.4)
    assert found.gains["k_i"] == pytest.approx(0.3730, rel=1e-3)
    assert found.verdicts[0].bound <= 1.4


def test_a_bound_on_control_is_certified_where_it_is_only_approached():
    """|CS| of a filtered PID tends to k_d over the filter's time as the frequency grows."""
    plant = RationalPlant([], [-1.0] * 3, 1.0, delay=1.0)
    effort = Peak("effort", Function.CONTROL, 1.5, "nominal")
    found = design(
        plant,
        structure.pid(0.05),
        maximise="k_i",
        sensitivity_peak=1.6,
        requirements=[effort],
    )
    verdict = {one.requirement: one for one in found.verdicts}["effort"]
    assert found.shaped.status is ShapeStatus.OPTIMAL
    assert found.gains["k_d"] / 0.05 == pytest.approx(1.5, rel=1e-4)
    assert found.gains["k_d"] / 0.05 <= verdict.bound <= 1.5


def test_a_bound_that_is_a_curve_is_judged_on_the_grid():
    found = design(LAG, structure.pi(), maximise="k_i", sensitivity_peak=lambda w: 1.4 + 0 * w)
    assert found.stability is Grounds.CERTIFIED
    assert found.verdicts[0].grounds is Grounds.GRID
    assert found.verdicts[0].allowed == 1


def test_without_a_certificate_that_closes_nothing_is_called_optimal(monkeypatch):
    monkeypatch.setattr(certificate, "_ROUNDS", 2)
    found = design(LAG, structure.pi(), maximise="k_i", sensitivity_peak=1.4)
    assert found.shaped.status is ShapeStatus.UNPROVEN
    assert found.verdicts[0].grounds is Grounds.OPEN
    assert not found.verdicts[0].kept


def test_what_the_grid_missed_is_shaped_away():
    """Frequencies given far too coarse: the certificate finds the peaks between them."""
    pole = complex(-0.03, 3.0)
    found = design(
        RationalPlant([], [-1.0, pole, pole.conjugate()], 9.0),
        structure.pi(),
        np.geomspace(0.01, 100, 12),
        maximise="k_i",
        sensitivity_peak=1.4,
    )
    assert found.shaped.status is ShapeStatus.OPTIMAL
    assert found.verdicts[0].bound <= 1.4
    assert found.gains["k_i"] == pytest.approx(0.0875, rel=2e-3)


def test_ratio_of_a_sampled_family_stays_on_its_grid():
    family = [control.frd(share * LAG, OMEGA) for share in (0.6, 1.4)]
    found = design(LAG, structure.pi(), maximise="k_i", ratio=0.5, family=family)
    known = design(LAG, structure.pi(), maximise="k_i", ratio=0.5, family=[0.6 * LAG, 1.4 * LAG])
    assert found.verdicts[0].grounds is Grounds.GRID
    assert known.verdicts[0].grounds is Grounds.CERTIFIED
    assert found.gains["k_i"] == pytest.approx(known.gains["k_i"], rel=1e-3)
