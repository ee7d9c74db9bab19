"""Measured responses as members of the true family."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.figures.panels import _left_curves, four_panels
from mptune.loops.broken import FORCE, VELOCITY
from mptune.loops.family import FamilyLoops
from mptune.loops.force_dynamics import force_dynamics
from mptune.loops.stability import count_unstable_poles
from mptune.params.pack import pack_filters
from mptune.params.packed import NO_PATH, LoopGains, NominalPlant, Plants
from mptune.robust.condition import sides
from mptune.robust.margins import family_margins
from mptune.robust.measured import ForceResponse, Members
from mptune.robust.measured_loops import count_members, member_margins
from mptune.robust.result import Status
from mptune.robust.store import to_dataset
from mptune.robust.sweep import sweep
from mptune.robust.tables import place_text, undecided_text

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

GAINS = LoopGains(700e3, 13.0, 22.0, 42.0, 0.55, 0.006)
NOMINAL = NominalPlant(24500.0, 0.011)
SHARE, DELAY, TAU_A, TAU_B = 0.571, 0.018, 0.012, 0.009
MASSES = np.array([24500.0, 49000.0])


def force(omega, delay=DELAY):
    s = 1j * np.asarray(omega)
    return force_dynamics(s, TAU_A, TAU_B, SHARE) * np.exp(-s * delay)


def response_of(omega, name="rig", delay=DELAY):
    return ForceResponse(name, np.asarray(omega, float), force(omega, delay))


def plants_of(masses, delay=DELAY):
    same = np.ones(len(masses))
    return Plants(masses, delay * same, TAU_A * same, TAU_B * same, SHARE * same)


def loops_of(plants, which=FORCE, path=NO_PATH):
    return FamilyLoops(plants, GAINS, path, which)


def both_sides(omega, plants, beside=None):
    """Return both sides over the plants, and over measured members beside or instead of them."""
    return sides(omega, loops_of(plants), NOMINAL, beside)


DENSE = np.geomspace(1.0, 400.0, 120)
BOX = Plants(MASSES, *(np.full(2, value) for value in (0.011, 1e-4, 1e-4, SHARE)))


def members(*responses, instead=False):
    return Members(responses or (response_of(DENSE),), MASSES, instead)


def test_a_response_that_is_a_plant_of_the_box_gives_that_plant_s_errors():
    omega = np.geomspace(1.5, 390, 200)
    expected = both_sides(omega, plants_of(MASSES))
    found = both_sides(omega, BOX, members())
    np.testing.assert_allclose(found.plant_ratio[:, 2:], expected.plant_ratio, rtol=2e-3)
    alone = both_sides(omega, BOX)
    np.testing.assert_allclose(found.left, np.maximum(alone.left, expected.left), rtol=2e-3)
    np.testing.assert_array_equal(found.right, alone.right)
    np.testing.assert_array_equal(found.plant_ratio[:, :2], alone.plant_ratio)
    assert found.plant.max() >= 2


def test_beside_can_only_raise_the_left_side_and_only_within_the_band():
    omega = np.geomspace(0.2, 2000, 300)
    alone = both_sides(omega, BOX)
    found = both_sides(omega, BOX, members())
    inside = (omega >= 1) & (omega <= 400)
    assert np.all(found.left >= alone.left)
    np.testing.assert_array_equal(found.left[:, ~inside], alone.left[:, ~inside])
    np.testing.assert_array_equal(found.plant[:, ~inside], alone.plant[:, ~inside])
    assert np.any(found.left[:, inside] > alone.left[:, inside])


def test_instead_leaves_the_box_out_where_every_response_speaks():
    """A wide box, a kind response: within the band only the response counts."""
    wide = plants_of(MASSES, delay=0.03)
    two = (response_of(DENSE, "a", 0.011), response_of(np.geomspace(3, 100, 60), "b", 0.012))
    omega = np.geomspace(0.2, 2000, 300)
    alone = both_sides(omega, wide)
    found = both_sides(omega, wide, members(*two, instead=True))
    inside = (omega >= 3) & (omega <= 100)
    assert np.all(found.plant[:, inside] >= 2)
    assert np.all(found.left[0, inside] < alone.left[0, inside])
    np.testing.assert_array_equal(found.left[:, omega > 400], alone.left[:, omega > 400])
    for loop in range(2):  # each ratio of the box is reached where the box still stands
        for n, at in enumerate(found.plant_frequency[loop, :2]):
            assert not inside[at]
            one = wide.picked(np.array([n]))
            ratio = both_sides(omega[at : at + 1], one).ratio[loop, 0]
            assert found.plant_ratio[loop, n] == pytest.approx(ratio, rel=1e-12)


@pytest.mark.parametrize("path", ["none", "filters"])
@pytest.mark.parametrize("delay", [0.012, 0.018, 0.03, 0.06])
@pytest.mark.parametrize("which", [VELOCITY, FORCE])
def test_the_count_agrees_with_that_of_the_same_plant_by_formula(boom, which, delay, path):
    path = NO_PATH if path == "none" else pack_filters(boom.study.controller)
    dense = response_of(np.geomspace(0.5, 600, 400), delay=delay)
    found = count_members(which, members(dense), GAINS, path)
    known = count_unstable_poles(loops_of(plants_of(MASSES, delay), which, path))
    assert found.decided.all()
    np.testing.assert_array_equal(found.unstable, known.unstable)


def test_the_counts_above_hold_stable_and_unstable_loops():
    stable = [count_unstable_poles(loops_of(plants_of(MASSES, delay))) for delay in (0.012, 0.06)]
    assert stable[0].stable.all()
    assert not stable[1].stable.any()


def test_margins_agree_with_those_of_the_same_plant_by_formula():
    dense = response_of(np.geomspace(0.5, 600, 400))
    found = member_margins(members(dense), GAINS, NO_PATH)
    known = family_margins(np.geomspace(0.5, 600, 2000), loops_of(plants_of(MASSES)))
    for name in known._fields:
        np.testing.assert_allclose(
            getattr(found, name), getattr(known, name), rtol=5e-3, err_msg=name
        )


def test_a_band_that_ends_before_the_loop_is_small_decides_nothing():
    short = response_of(np.geomspace(0.5, 12, 200))
    assert not count_members(VELOCITY, members(short), GAINS, NO_PATH).decided.any()


def test_a_band_that_starts_above_the_crossover_decides_nothing():
    late = response_of(np.geomspace(20, 600, 200))
    assert not count_members(VELOCITY, members(late), GAINS, NO_PATH).decided.any()


def test_steps_too_coarse_near_the_critical_point_decide_nothing():
    coarse = response_of(np.geomspace(0.5, 600, 6))
    assert not count_members(FORCE, members(coarse), GAINS, NO_PATH).decided.any()


def test_a_phase_that_cannot_be_followed_does_not_matter_where_the_loop_is_small():
    """Eight steps beyond 90° where |L| is certainly below 1 leave the count as it is."""
    near, far = np.geomspace(0.5, 150, 100), np.linspace(250, 1200, 9)
    wide = response_of(np.concatenate([near, far]))
    assert np.isinf(wide.doubt[-8:]).all()
    count = count_members(FORCE, members(wide), GAINS, NO_PATH)
    assert count.decided.all()
    fine = count_members(FORCE, members(), GAINS, NO_PATH)
    np.testing.assert_array_equal(count.unstable, fine.unstable)


def test_a_loop_near_the_critical_point_decides_nothing_unless_measured_finely():
    """At twice the delay margin's worth of delay the loop passes close by −1."""
    margins = family_margins(np.geomspace(0.5, 600, 2000), loops_of(plants_of(MASSES[:1])))
    critical = DELAY + float(margins.delay_margin[2, 0])
    near = response_of(np.geomspace(0.5, 600, 60), delay=critical * 1.001)
    one = Members((near,), MASSES[:1], instead=False)
    assert not count_members(FORCE, one, GAINS, NO_PATH).decided.any()


def test_a_phase_that_turns_too_far_between_points_is_in_doubt():
    far = response_of([1.0, 2.0, 100.0, 200.0, 400.0])
    assert np.isinf(far.doubt[1])
    assert np.isfinite(far.doubt[0])


def test_the_stated_doubt_covers_the_error_of_interpolation():
    sparse = response_of(np.geomspace(1, 300, 40))
    fine = np.geomspace(1, 300, 4001)[1:-1]
    error = np.abs(sparse.at(fine) / force(fine) - 1)
    interval = np.searchsorted(sparse.omega, fine, side="right") - 1
    assert np.all(error <= sparse.doubt[interval])
    assert np.max(error) > 1e-5


def test_outside_its_band_a_response_says_nothing():
    one = response_of(DENSE)
    assert np.isnan(one.at(np.array([0.5, 500.0]))).all()
    np.testing.assert_allclose(one.at(DENSE), force(DENSE), rtol=1e-12)


@pytest.fixture
def rig_study(load_measured):
    """The boom study with one response measured on a plant of this delay."""

    def load(delay, place="beside", omega=None):
        omega = np.geomspace(0.5, 600, 300) if omega is None else omega
        return load_measured(omega, force(omega, delay), place=place)

    return load


def test_a_sweep_names_the_measured_response_that_binds(rig_study):
    result = sweep(rig_study(delay=0.026))
    for condition in result.conditions:
        assert condition.at.response == "rig"
        assert condition.at.mass_kg == 24500
        assert condition.status is Status.VIOLATED
        assert condition.plant_ratio.shape == (16 + 2,)
    at = result.json()["velocity"]["at"]
    assert at["response"] == "rig"
    assert at["delay_s"] is None
    family = result.family("none")
    assert len(family.stable) == 18
    assert family.decided.all()
    assert family.worst("sensitivity_peak", FORCE)[1].response == "rig"


def test_a_kind_response_beside_the_box_changes_no_verdict(rig_study, load_boom):
    result = sweep(rig_study(delay=0.012))
    alone = sweep(load_boom(corners=True))
    for one, other in zip(result.conditions, alone.conditions, strict=True):
        assert one.status is other.status
        assert one.at.response is None
        assert one.worst_ratio == pytest.approx(other.worst_ratio, rel=1e-3)


def test_instead_judges_by_the_response_alone_within_its_band(rig_study):
    beside = sweep(rig_study(delay=0.012))
    alone = sweep(rig_study(delay=0.012, place="instead"))
    assert alone.velocity.worst_ratio < beside.velocity.worst_ratio
    family = alone.family("none")
    assert family.responses == ("rig", "rig")
    assert len(family.stable) == 2
    stored = to_dataset(alone)
    assert list(stored["response"].values[-2:]) == ["rig", "rig"]
    assert stored["stable"].sel(path="none").values.tolist() == [-1] * 16 + [1, 1]
    continuous = stored["gain_margin"].sel(path=["none", "filters"]).values
    assert np.isnan(continuous[..., :16]).all()


def test_an_undecided_member_is_said_and_not_taken_for_stable(rig_study):
    short = np.geomspace(0.5, 12, 200)
    result = sweep(rig_study(delay=0.012, omega=short))
    check = next(one for one in result.checks if one.key == "unstable_plants")
    assert check.status is Status.UNDECIDED
    assert check.found == 2
    assert check.at.response == "rig"
    assert result.position.status is Status.UNDECIDED
    assert not result.satisfied
    assert result.json()["true_family"]["none"]["undecided_plants"] == 2
    assert "around measured rig: not taken for stable" in undecided_text(result)


def test_where_all_is_decided_nothing_is_said(load_boom):
    assert undecided_text(sweep(load_boom(corners=True))) is None


def test_the_worst_plant_of_the_tables_is_named(rig_study):
    result = sweep(rig_study(delay=0.026))
    assert place_text(result.velocity.at).startswith("24.5 t, measured rig, ω ")


def test_panels_hold_the_members_and_leave_out_what_they_replace(rig_study):
    result = sweep(rig_study(delay=0.012, place="instead"))
    omega, curves = _left_curves(result)
    inside = (omega >= 0.5) & (omega <= 600)
    assert curves.shape[1] == 16 + 2
    assert np.all(curves[:, :16, inside] == 0)
    assert np.all(curves[:, :16, ~inside] > 0)
    assert np.all(curves[:, 16:, ~inside] == 0)
    assert np.all(curves[:, 16:, inside].max(axis=1) > 0)
    assert four_panels(result).axes[0].lines
