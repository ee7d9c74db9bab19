"""The points of a campaign, and what makes it this campaign."""

import numpy as np
import pytest

from mptune.campaign.plan import noise_of
from mptune.errors import InputError

METHODS = ("monte carlo", "sobol")


@pytest.mark.parametrize("method", METHODS)
def test_points_fill_the_box_and_leave_what_is_fixed_alone(plan, method):
    one = plan(f"method={method}", "runs=256")
    low, high = one.box.low, one.box.high
    assert ((one.points >= low) & (one.points <= high)).all()
    unit = (one.points - low)[:, one.box.varying] / (high - low)[one.box.varying]
    assert np.abs(unit.mean(axis=0) - 0.5).max() < 0.1
    fixed = np.setdiff1d(np.arange(len(low)), one.box.varying)
    assert (one.points[:, fixed] == low[fixed]).all()


@pytest.mark.parametrize("method", METHODS)
def test_a_run_has_the_same_parameters_however_many_there_are(plan, method):
    few, many = plan(f"method={method}", "runs=7"), plan(f"method={method}", "runs=40")
    assert np.array_equal(few.points, many.points[:7])


@pytest.mark.parametrize("method", METHODS)
def test_another_seed_draws_other_machines(plan, method):
    one, other = (plan(f"method={method}", "runs=8", f"seed={seed}") for seed in (1, 2))
    assert not np.isclose(one.points[:, 0], other.points[:, 0]).any()


def test_sobol_points_are_spread_more_evenly_than_draws(plan):
    def widest_gap(method):
        masses = np.sort(plan(f"method={method}", "runs=128").points[:, 0])
        return np.diff(masses).max()

    assert widest_gap("sobol") < 0.6 * widest_gap("monte carlo")


def test_a_grid_holds_every_corner_once(plan):
    one = plan("method=grid", "points=3")
    assert one.runs == 3 ** len(one.box.varying)
    assert len(np.unique(one.points, axis=0)) == one.runs
    assert (one.points == one.box.low).all(axis=1).sum() == 1
    assert (one.points == one.box.high).all(axis=1).sum() == 1


def test_a_grid_too_large_to_run_is_refused(plan):
    with pytest.raises(InputError, match=r"campaign\.points"):
        plan("method=grid", "points=101", "friction=[0.5, 2]")


def test_chunks_hold_every_run_once(plan):
    one = plan("runs=25", "chunk=10")
    assert [len(chunk) for chunk in one.chunks] == [10, 10, 5]
    assert [index for chunk in one.chunks for index in chunk] == list(range(25))


def test_noise_is_a_runs_own_and_always_the_same():
    first = noise_of(1, 3).standard_normal(4)
    assert np.array_equal(first, noise_of(1, 3).standard_normal(4))
    assert not np.isclose(first, noise_of(1, 4).standard_normal(4)).any()
    assert not np.isclose(first, noise_of(2, 3).standard_normal(4)).any()


def test_identity_follows_what_decides_the_results_and_nothing_else(plan, load_boom):
    from mptune.campaign.plan import plan_campaign

    def identity(*overrides):
        return plan_campaign(load_boom(*overrides)).identity()

    own = identity()
    assert identity("title=another", "verification.seeds=[9]") == own
    for change in ("campaign.seed=2", "campaign.runs=999", "gains.xi=0.6", "load.force=5 kN",
                   "verification.start=0.14 m", "campaign.limits.final_error=1 mm"):  # fmt: skip
        assert identity(change) != own, change


def test_the_campaign_is_no_part_of_the_hash_that_gains_are_tied_to(boom, load_boom):
    assert load_boom("campaign.seed=2", "uncertainty.points=7").hash() == boom.hash()
