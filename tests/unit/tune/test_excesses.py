"""The requirements as the search sees them, against the whole family's sweep."""

from dataclasses import replace

import numpy as np
import pytest

from mptune.params.packed import Plants
from mptune.robust.model import LinearModel
from mptune.robust.sweep import sweep
from mptune.tune.excesses import Excesses

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

ASKED = (
    "requirements.sensitivity_peak=4.0",
    "requirements.complementary_peak=3.0",
    "requirements.sampled_sensitivity_peak=3.0",
    "requirements.gain_margin=1.3",
    'requirements.noise_gain="30 MN/m"',
    "requirements.disk_margin=0.3",
    'requirements.phase_margin="20 deg"',
    'requirements.delay_margin="6 ms"',
    'requirements.peak_compliance="2e-7 m/N"',
    "requirements.overshoot=0.3",
    'requirements.settling_time="1 s"',
)
SECTION_5_1 = 'uncertainty.delay=["10 ms", "14 ms"]'
LIMITS = {
    "position_ratio": 0.48,
    "sensitivity_peak": 4.0,
    "complementary_peak": 3.0,
    "sampled_sensitivity_peak": 3.0,
    "gain_margin": 1.3,
    "noise_gain": 30e6,
    "disk_margin": 0.3,
    "phase_margin": np.pi / 9,
    "delay_margin": 6e-3,
    "peak_compliance": 2e-7,
    "overshoot": 0.3,
    "settling_time": 1.0,
}
SIGNED = ("disk_margin", "phase_margin", "delay_margin")  # their excess is 1 − found/limit
IN_HAND = {"position_ratio": 5e-4}  # of what is allowed; 1e-5 of every other
GAINS = {
    "published": {},
    "slow": {"k_p_pos": 8.0, "k_p_vel": 5e5},
    "soft": {"k_p_pos": 10.0, "k_i_pos": 60.0, "omega": 30.0, "xi": 0.4, "tau": 0.005},
}


@pytest.fixture(scope="module")
def study(load_boom):
    return load_boom(*ASKED, SECTION_5_1, "uncertainty.points=3")


@pytest.mark.parametrize("name", GAINS)
@pytest.mark.parametrize("path", ["none", "filters"])
def test_worst_excesses_are_the_sweeps_figures_over_the_limits(load_boom, name, path):
    study = load_boom(
        *ASKED, SECTION_5_1, f'model.measurement_path="{path}"', "uncertainty.points=3"
    )
    model = LinearModel.of(study)
    required = Excesses(model, model.gains)
    gains = model.gains._replace(**GAINS[name])
    own = study.study.gains.model_copy(update=GAINS[name])
    swept = sweep(study, own)
    checks = {check.key: check for check in swept.checks}
    for one in required.worst(gains):
        check, limit = checks[one.requirement], LIMITS.get(one.requirement, 1.0)
        if one.requirement == "unstable_plants":
            assert one.excess == pytest.approx(1e-3 - checks["disk_margin"].found, rel=1e-6)
            continue
        if one.requirement == "settling_time":  # its excess is the deviation from then on
            assert (one.excess > 0) == (check.found > limit)
            continue
        over = check.found / limit if one.requirement != "gain_margin" else limit / check.found
        kept = IN_HAND.get(one.requirement, 1e-5)
        error = np.exp(one.excess) * (1 - kept) / over - 1
        if one.requirement in SIGNED:
            error = (1 - one.excess) / (1 - kept) / over - 1
        print(f"{name}, {path}, {one.requirement}: {over:.4f}, off by {error:.1e}")
        # The search's grid can only miss what the sweep's refinement finds: that is kept in hand.
        # Certified brackets of phase and delay margin are open by 1 %, and the search counts
        # more delay as a turn of the whole loop.
        open_by = 2e-2 if one.requirement in SIGNED[1:] else 0.0
        assert abs(error) < max(1.2 * kept, 2e-5, open_by)
        if check.at is not None and np.isfinite(one.frequency) and not open_by:
            found = one.at(model)
            assert found.mass_kg == check.at.mass_kg
            assert found.frequency_rad_s == pytest.approx(check.at.frequency_rad_s, rel=5e-3)


def test_a_plant_that_is_worse_inside_the_box_is_found_and_added(load_boom):
    """One plant amid the masses is given lags and a delay that no corner has."""
    study = load_boom(*ASKED, SECTION_5_1, corners=True)
    model = LinearModel.of(study)
    corners = len(model.plants.mass)
    planted = (30e3, 0.019, 0.02, 0.02, model.plants.share_a[0])
    one = Plants(*(np.array([value]) for value in planted))
    worse = replace(
        model, lumped=model.lumped.followed_by(one), explicit=model.explicit.followed_by(one)
    )
    required = Excesses(worse, worse.gains)
    required._true = np.arange(4)
    required._ask_sampled(required._true)
    before = required.of(worse.gains)
    found, added = required.grow(worse.gains)
    assert added
    named = {one.plant for one in found if one.requirement not in {"noise_gain", "overshoot"}}
    assert named == {corners}
    names, after = np.array(required.names), required.of(worse.gains)
    assert len(names) == len(after) > len(before)
    for one in found:
        asked = after[names == one.requirement].max()
        assert asked == pytest.approx(one.excess, abs=1e-9), one.requirement
    assert not required.grow(worse.gains)[1]


def test_a_plant_that_breaks_a_requirement_by_little_is_added_too(load_boom):
    """What the search is not asked it cannot mend: 2e-4 over the limit is over the limit."""
    model = LinearModel.of(load_boom(*ASKED, SECTION_5_1, corners=True))
    required = Excesses(model, model.gains)
    found = {one.requirement: one for one in required.worst(model.gains)}
    top = found["sensitivity_peak"].plant
    limit = 4.0 * np.exp(found["sensitivity_peak"].excess - 2e-4)
    asked = model.requirements.model_copy(update={"sensitivity_peak": limit})
    inner = model.study.study.model_copy(update={"requirements": asked})
    tight = LinearModel.of(model.study.model_copy(update={"study": inner}))
    required = Excesses(tight, tight.gains)
    required._true = np.setdiff1d(required._true, [top])
    assert required.grow(tight.gains)[1]
    assert top in required._true


@pytest.mark.parametrize("factor", [2.5, 6.0, 40.0])
def test_unstable_sampled_loops_exceed_and_every_excess_is_a_number(study, factor):
    model = LinearModel.of(study)
    required = Excesses(model, model.gains)
    gains = model.gains._replace(k_p_vel=factor * model.gains.k_p_vel)
    names, excesses = np.array(required.names), required.of(gains)
    assert np.isfinite(excesses).all()
    for name in ("sampled_sensitivity_peak", "gain_margin"):
        assert excesses[names == name].max() > 0
    shares = [
        excesses[names == "gain_margin"].max()
        for excesses in (
            required.of(model.gains._replace(k_p_vel=one * gains.k_p_vel)) for one in (0.9, 1.1)
        )
    ]
    assert shares[0] < excesses[names == "gain_margin"].max() < shares[1]  # the way back is seen


def test_excesses_are_smooth_enough_for_differences(study):
    """Two step sizes of the forward differences agree where no peak changes its plant."""
    model = LinearModel.of(study)
    required = Excesses(model, model.gains)

    def at(step):
        return required.of(model.gains._replace(k_p_pos=model.gains.k_p_pos * np.exp(step)))

    base = at(0.0)
    fine, coarse = (at(1e-5) - base) / 1e-5, (at(1e-4) - base) / 1e-4
    off = np.abs(fine - coarse) > 1e-2 * (1 + np.abs(coarse))
    assert off.mean() < 0.05


def test_short_delays_leave_no_sampled_loop_to_ask(load_boom):
    model = LinearModel.of(
        load_boom(*ASKED, 'uncertainty.delay_as_it_runs=["3 ms", "14 ms"]', corners=True)
    )
    names = Excesses(model, model.gains).names
    assert "gain_margin" not in names
    assert "sensitivity_peak" in names


# Measured members ------------------------------------------------------------------------------


@pytest.fixture
def measured(load_measured):
    """Return the boom study with one measured force response: slow, within a band."""

    def study(delay, *overrides, place="beside", low=0.05, high=600.0):
        omega = np.geomspace(low, high, 400)
        force = np.exp(-1j * omega * delay) / (1 + 1j * omega * 0.012)
        return load_measured(omega, force, *overrides, place=place)

    return study


@pytest.mark.parametrize("place", ["beside", "instead"])
def test_measured_members_are_asked_of_both_conditions_and_the_peaks(measured, place):
    study = measured(0.03, "requirements.sensitivity_peak=4.0", place=place)
    model = LinearModel.of(study)
    required = Excesses(model, model.gains)
    swept = sweep(study)
    names, excesses = np.array(required.names), required.of(model.gains)
    ratio = np.exp(excesses[names == "position_ratio"].max()) * 0.48 * (1 - 5e-4)
    assert ratio == pytest.approx(swept.position.worst_ratio, rel=1e-3)
    worst = {one.requirement: one for one in required.worst(model.gains)}
    point = worst["position_ratio"].at(model)
    assert point == swept.position.at or point.mass_kg == swept.position.at.mass_kg
    assert "rig" in str(point.values())
    peak = worst["sensitivity_peak"]
    assert "rig" in str(peak.at(model).values())
    assert excesses[names == "sensitivity_peak"].max() == pytest.approx(peak.excess, abs=1e-12)
    required.grow(model.gains)
    assert required._true.max(initial=0) < len(model.plants.mass)
    assert required._envelope.max(initial=0) < len(model.plants.mass)


def test_the_tuner_keeps_the_requirements_for_measured_members_too(measured):
    from mptune.tune.tuner import tune

    alone = tune(measured(0.02, low=1.0, high=1.01))  # a band of next to nothing
    found = tune(measured(0.024))
    print(f"K_P,vel {alone.gains.k_p_vel:.4g} -> {found.gains.k_p_vel:.4g} N s/m")
    assert found.sweep.satisfied
    assert found.gains.k_p_vel < 0.99 * alone.gains.k_p_vel  # Eq. 17 sees it
    assert found.sweep.velocity.at.values()["response"] == "rig"


def test_a_measured_member_that_stands_in_the_way_is_named(measured):
    from mptune.tune.tuner import tune

    found = tune(measured(0.06, "requirements.position_ratio=0.12"))
    assert found.status.value == "infeasible"
    assert found.blocking.requirement == "position_ratio"
    assert "rig" in str(found.blocking.at.values())


def test_undecided_stability_is_said_not_a_figure_that_is_kept(measured):
    """A band that ends before the loop is small leaves the encirclements open."""
    from mptune.tune.tuner import tune

    found = tune(measured(0.024, high=30.0))
    assert found.status.value == "infeasible"
    assert "undecided" in found.blocking.remedy
