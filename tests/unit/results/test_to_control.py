"""Loops and controllers as python-control's objects, against its own margins and responses."""

import sys

import control
import numpy as np
import pytest

import mptune
from mptune.identify.responses import from_frd
from mptune.loops.position import position_controller
from mptune.loops.sampled import sampled_controller
from mptune.params.pack import pack_gains
from mptune.robust.result import SweepResult
from mptune.shape.structure import basis_of, p, pi, pid, position

FORCE = 2
OMEGA = np.geomspace(0.5, 500, 3000)


def number_of(result, at):
    """Return the place of a plant in the family."""
    columns = np.array(result.plants[:4]).T
    wanted = (at.mass_kg, at.delay_s, at.tau_a_s, at.tau_b_s)
    return int(np.argmin(np.abs(columns / np.array(wanted) - 1).max(axis=1)))


@pytest.mark.parametrize("path", ["none", "filters"])
def test_python_control_finds_the_margins_of_a_loop_at_its_plant(section_5_1, path):
    at = section_5_1.position.at
    frd = section_5_1.to_control("force", path, at, OMEGA)
    assert frd.dt == 0
    gain, phase, *_ = control.stability_margins(frd)
    margins = section_5_1.family(path).margins
    n = number_of(section_5_1, at)
    assert gain == pytest.approx(margins.gain_margin[FORCE, n], rel=1e-4)
    assert np.radians(phase) == pytest.approx(margins.phase_margin[FORCE, n], rel=1e-4)


def test_as_it_runs_in_sampled_time(section_5_1):
    at = section_5_1.position.at
    frd = section_5_1.to_control("force", "sampled", at)
    assert frd.dt == section_5_1.model.period
    assert frd.omega[-1] <= np.pi / frd.dt
    peak = np.abs(1 / (1 + frd.complex)).max()
    n = number_of(section_5_1, at)
    exact = section_5_1.family("sampled").margins.sensitivity_peak[FORCE, n]
    assert peak == pytest.approx(exact, rel=2e-2)  # on the first grid
    assert peak <= exact * (1 + 1e-9)


def test_dead_time_is_exact(fig_5):
    """Eq. 14's loop: |L| and phase of K/(ms) e^{-sd}, at a frequency where Padé's would be off."""
    omega = np.array([10.0, 400.0])
    frd = fig_5.to_control("velocity", "none", omega=omega)
    nominal, gain = fig_5.model.nominal, fig_5.gains.k_p_vel
    s = 1j * omega
    expected = gain / (nominal.mass * s) * np.exp(-s * nominal.delay)
    np.testing.assert_allclose(frd.complex, expected, rtol=1e-12)


def test_the_models_own_gains_path_and_grid_are_taken_where_none_are_given(fig_5):
    frd, own = fig_5.model.to_control(), fig_5.model.to_control(fig_5.gains, "force", "none")
    np.testing.assert_array_equal(frd.complex, own.complex)
    assert len(frd.omega) == 400


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"loop": "outer"}, r"`loop` = 'outer' .*choose velocity, position, force"),
        ({"path": "long"}, r"`path` = 'long' .*choose none, filters or sampled"),
        ({"loop": "velocity", "path": "sampled"}, r"`path` = 'sampled' .*loop=\"force\""),
    ],
)
def test_what_is_no_loop_is_refused(fig_5, options, message):
    with pytest.raises(mptune.InputError, match=message):
        fig_5.to_control(**options)


@pytest.fixture
def measured(write_study, tmp_path):
    """Sweep the boom with a measured response that is exactly e^{-sd}/(τs + 1)."""
    omega = np.geomspace(0.5, 400, 200)
    lag = np.exp(-0.03j * omega) / (0.01j * omega + 1)
    response = mptune.FrequencyResponse(omega, lag, np.ones(200), "rig")
    mptune.write_response(tmp_path / "rig.v2.csv", response)
    study = write_study({"uncertainty.points": "2", "uncertainty.measured": '["rig.v2.csv"]'})
    return mptune.sweep(mptune.load_study(str(study)))


@pytest.mark.parametrize("loop", ["velocity", "position", "force"])
def test_a_measured_member_has_its_loop_at_its_frequencies(measured, loop):
    at = measured.velocity.at
    assert at.response is not None
    found = measured.to_control(loop, "filters", at)
    assert len(found.omega) == 200
    box = mptune.PlantPoint(at.mass_kg, 0.03, 0.01, 0.01, 1.0)
    same = measured.to_control(loop, "filters", box, found.omega)
    np.testing.assert_allclose(found.complex, same.complex, rtol=1e-9)
    with pytest.raises(mptune.InputError, match=r"`path` = 'sampled'"):
        measured.to_control(loop, "sampled", at)


def test_a_response_that_was_not_measured_is_refused_with_those_that_were(measured, fig_5):
    at = mptune.PlantPoint(3e4, np.nan, np.nan, np.nan, 1.0, "ship")
    with pytest.raises(mptune.InputError, match=r"`plant` = 'ship' .*; rig"):
        measured.to_control(plant=at)
    with pytest.raises(mptune.InputError, match="none was measured"):
        fig_5.to_control(plant=at)


def test_eq_22_continuous_and_as_the_target_runs_it(fig_5):
    gains, s = fig_5.gains, 1j * OMEGA
    packed = pack_gains(gains)
    found = mptune.controller_to_control(gains)
    assert isinstance(found, control.TransferFunction)
    np.testing.assert_allclose(found(s), position_controller(s, *packed[1:]), rtol=1e-9)
    period = fig_5.model.period
    discrete = mptune.controller_to_control(gains, period)
    assert discrete.dt == period
    expected = sampled_controller(s, packed, period)
    np.testing.assert_allclose(discrete(np.exp(s * period)), expected, rtol=1e-7)


def test_without_integral_there_is_no_pole_at_the_origin(fig_5):
    gains = fig_5.gains.model_copy(update={"k_i_pos": 0.0})
    assert np.abs(mptune.controller_to_control(gains).poles()).min() > 1.0
    discrete = mptune.controller_to_control(gains, 0.01)
    assert np.abs(discrete.poles() - 1).min() > 0.1


@pytest.mark.parametrize("structure", [p(), pi(), pid(0.05), position(0.006)])
def test_a_structure_is_the_fraction_that_it_says(structure):
    x = np.arange(1.0, 1 + len(structure.names))
    numerator, denominator = structure.fraction(x)
    s = 1j * OMEGA
    expected = np.polyval(numerator, s) / np.polyval(denominator, s)
    np.testing.assert_allclose(structure.controller(x, OMEGA), expected, rtol=1e-9)


def test_a_designed_controller():
    plant = control.tf([1], [1, 3, 3, 1])
    found = mptune.design(plant, mptune.pi_structure(), maximise="k_i", sensitivity_peak=1.4)
    controller = found.to_control()
    assert isinstance(controller, control.TransferFunction)
    sensitivity = 1 / (1 + (plant * controller)(1j * np.geomspace(1e-2, 1e2, 5000)))
    assert np.abs(sensitivity).max() == pytest.approx(1.4, rel=1e-3)


def test_a_designed_controller_of_functions_of_ones_own_is_a_response():
    late = basis_of([lambda s: np.exp(-0.1 * s)], ["k"])
    found = mptune.design(
        lambda s: 1 / (s + 1), late, maximise="k", sensitivity_peak=1.4, high={"k": 50.0}
    )
    controller = found.to_control()
    assert isinstance(controller, control.FrequencyResponseData)
    k = found.gains["k"]
    np.testing.assert_allclose(controller.complex, k * np.exp(-0.1j * controller.omega))
    with pytest.raises(mptune.InputError, match="not known as a fraction"):
        late.fraction(np.ones(1))


def test_a_frequency_response_goes_there_and_back(results):
    one = results["response"]
    back = from_frd(one.to_control(), one.name)
    np.testing.assert_array_equal(back.omega, one.omega)
    np.testing.assert_array_equal(back.response, one.response)


def test_without_python_control_it_is_named_with_its_remedy(fig_5, monkeypatch):
    monkeypatch.setitem(sys.modules, "control", None)
    with pytest.raises(mptune.InputError, match=r"python-control is not installed; pip install"):
        fig_5.to_control()
    with pytest.raises(mptune.InputError, match="python-control"):
        mptune.controller_to_control(fig_5.gains)


def test_a_family_is_found_by_its_path(fig_5):
    assert fig_5.family("sampled") is fig_5.sampled
    assert fig_5.family("filters").path == "filters"
    with pytest.raises(mptune.InputError, match=r"'long' is no measurement path; one of none, fil"):
        fig_5.family("long")


def test_a_sampled_family_that_cannot_be_says_why(load_boom):
    study = load_boom(
        'uncertainty.delay_as_it_runs=["2 ms", "4 ms"]',
        "objective.tracking_loop=continuous",
        corners=True,
    )
    result = mptune.sweep(study)
    assert isinstance(result, SweepResult)
    with pytest.raises(mptune.InputError, match=r"0\.002 s, is below 0\.005 s; raise uncertainty"):
        result.family("sampled")
    with pytest.raises(mptune.InputError, match=r"total delay of at least 0\.005 s"):
        result.to_control(path="sampled")
