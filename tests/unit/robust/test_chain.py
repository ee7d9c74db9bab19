"""The chain of gain factors: each link's factor is a border, and the search finds borders."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.loops.sampled import stable_as_sampled
from mptune.loops.stability import count_unstable_poles
from mptune.robust.chain import LARGEST, Link, chain, factor_text, gain_limit
from mptune.robust.sweep import sweep

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

JUST = 1e-3  # distance from a border at which its two sides are told apart


class Counted:
    """A loop that is stable up to a limit (and above a lower one), counting how often asked."""

    def __init__(self, limit, floor=0.0):
        self.limit, self.floor, self.asked = limit, floor, 0

    def __call__(self, factor):
        self.asked += 1
        return self.floor < factor <= self.limit


@pytest.mark.parametrize("limit", [0.017, 0.3, 0.9999, 1.0, 1.0001, 1.7, 2.0, 40.0, 63.9])
def test_the_limit_is_found_from_below(limit):
    holds = Counted(limit)
    found = gain_limit(holds)
    assert found <= limit
    assert found == pytest.approx(limit, rel=1e-6)
    assert holds.asked < 40


def test_a_coarser_search_asks_less_and_stays_below():
    fine, coarse = Counted(1.52), Counted(1.52)
    assert gain_limit(fine) > gain_limit(coarse, 0.02) > 1.52 / 1.02
    assert coarse.asked < fine.asked / 2


def test_what_always_holds_has_no_limit_and_what_never_holds_cannot_be_told():
    assert gain_limit(lambda _: True) == np.inf
    assert gain_limit(Counted(2 * LARGEST)) == np.inf
    assert np.isnan(gain_limit(lambda _: False))
    assert np.isnan(gain_limit(Counted(1e-3)))


def test_factors_are_printed_with_their_meaning():
    assert factor_text(1.2321) == "1.232"
    assert factor_text(np.inf) == "above 64"
    assert factor_text(np.nan) == "cannot be told"


def test_json_says_no_number_that_json_cannot_say():
    assert Link("sampled", np.nan, None).json() == {
        "model": "sampled",
        "gain_factor": None,
        "guaranteed_gain_factor": None,
        "stability": "stable",
        "at": None,
    }


PUBLISHED = {
    "Eq. 17 and 21": 1.99,
    "true family": 2.06,
    "with measurement path": 1.232,
    "sampled": 1.240,
}


def test_the_published_gains_over_the_ranges_of_5_1(section_5_1):
    """What the inequalities leave out costs most of the margin."""
    links = chain(section_5_1)
    for link in links:
        print(f"{link.name}: {link.factor:.4f} at {link.at}")
    assert [link.name for link in links] == list(PUBLISHED)
    for link in links:
        assert link.factor == pytest.approx(PUBLISHED[link.name], abs=0.006)
        assert link.at.mass_kg == 24500
        assert link.at.delay_s == 0.014


def stable(result, name, factor):
    """Return whether a link's model holds with the gain at F_ref scaled."""
    model = result.model
    gains = result.gains.model_copy(update={"k_p_vel": factor * result.gains.k_p_vel})
    if name == "Eq. 17 and 21":
        again = sweep(model.study, gains)
        return all(one.worst_ratio < 1 and one.nominal_stable for one in again.conditions)
    if name == "sampled":
        return stable_as_sampled(model.as_it_runs(gains), model.period)[0].all()
    path = "none" if name == "true family" else "filters"
    return count_unstable_poles(model.loops(gains, model.path_of(path))).stable.all()


CASES = {
    "Fig. 5": ("", ()),
    "Fig. 5, unstable with its path": ("", ('uncertainty.delay_as_it_runs=["11 ms", "21.5 ms"]',)),
    "Sec. 5.1": ("section-5-1", ()),
    "far too high": ("", ("gains.k_p_vel=2500 kN s/m",)),
    "low": ("section-5-1", ("gains.k_p_vel=150 kN s/m", "gains.k_i_pos=3 1/s^2")),
    "no integral term": ("section-5-1", ("gains.k_i_pos=0 1/s^2",)),
}


@pytest.mark.parametrize("case", CASES)
def test_every_factor_is_a_border(load_boom, case):
    name, overrides = CASES[case]
    result = sweep(load_boom(*overrides, uncertainty=name, corners=True))
    links = chain(result)
    print(case, {link.name: round(link.factor, 4) for link in links})
    for link in links:
        assert stable(result, link.name, (1 - JUST) * link.factor), link.name
        assert not stable(result, link.name, (1 + JUST) * link.factor), link.name


@pytest.mark.parametrize("case", CASES)
def test_the_inequalities_promise_no_more_than_the_true_family_keeps(load_boom, case):
    name, overrides = CASES[case]
    links = chain(sweep(load_boom(*overrides, uncertainty=name, corners=True)))
    factor = {link.name: link.factor for link in links}
    assert factor["Eq. 17 and 21"] <= factor["true family"] * (1 + 1e-4)
    assert factor["with measurement path"] < factor["true family"]


def test_a_family_that_no_one_factor_makes_stable_has_none(load_boom):
    """A heavy plant needs the gain that a light one does not bear."""
    overrides = ['uncertainty.sets.section-5-1.mass=["11 t", "250 t"]']
    result = sweep(load_boom(*overrides, uncertainty="section-5-1", corners=True))
    light = result.plants.mass < 100e3
    family = result.family("filters")
    assert not family.stable[light].all()
    assert family.stable[~light].all()
    for link in chain(result):
        if link.name in {"with measurement path", "sampled"}:
            assert np.isnan(link.factor)
            assert link.at is None


def test_without_room_for_the_hold_there_is_no_sampled_link(load_boom):
    short = 'uncertainty.delay_as_it_runs=["4 ms", "12 ms"]'
    result = sweep(load_boom(short, "objective.tracking_loop=continuous", corners=True))
    assert [link.name for link in chain(result)] == list(PUBLISHED)[:3]


def test_a_requirement_on_the_ratio_does_not_move_the_chain(load_boom):
    plain = sweep(load_boom(uncertainty="section-5-1", corners=True))
    tight = sweep(
        load_boom("requirements.velocity_ratio=0.6", uncertainty="section-5-1", corners=True)
    )
    assert chain(tight)[0].factor == pytest.approx(chain(plain)[0].factor, rel=1e-4)
