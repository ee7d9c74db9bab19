"""The words of a verdict: each one, and which takes precedence over which."""

import itertools

import numpy as np
import pytest

from mptune.certify.result import Stability
from mptune.params.headline import Headline
from mptune.robust.chain import GAIN_RESERVE, Link, chain
from mptune.robust.headline import judge, judge_sweep
from mptune.robust.place import PlantPoint
from mptune.robust.result import Check, Status
from mptune.robust.sweep import sweep

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

PLANT = PlantPoint(24500.0, 0.0215, 0.0122, 0.0119, float("nan"))
SHORT = 'uncertainty.delay=["11 ms", "14 ms"]'  # the loop then runs with a reserve


def check(status, found=0.5):
    return Check("position_ratio", "position_ratio", "≤ 0.48", found, status, PLANT)


def link(factor=1.5, **changes):
    return Link("sampled", factor, PLANT, **changes)


GOOD, SOUND = check(Status.SATISFIED), link()
CHECKS = {
    "undecided": check(Status.UNDECIDED),
    "not converged": check(Status.NOT_CONVERGED),
    "not evaluated": check(Status.NOT_EVALUATED),
    "violated": check(Status.VIOLATED),
    "unstable": check(Status.UNSTABLE),
}
LINKS = {
    "undecided": link(stability=Stability.UNDECIDED, witness=PLANT),
    "unstable": link(stability=Stability.UNSTABLE, witness=PLANT, note="3 of 16 plants"),
    "short": link(1.0999),
    "unknown": link(np.nan),
    "short as proved": link(1.12, guaranteed=1.09),
}


@pytest.mark.parametrize(
    ("name", "word"),
    [
        ("undecided", Headline.UNDECIDED),
        ("not converged", Headline.UNDECIDED),
        ("not evaluated", Headline.UNDECIDED),
        ("violated", Headline.NOT_MET),
        ("unstable", Headline.NOT_MET),
    ],
)
def test_a_requirement_decides(name, word):
    found = judge((GOOD, CHECKS[name]), (SOUND,))
    assert found.word is word
    assert "position_ratio" in found.reason
    assert found.witness == PLANT
    assert not found.met


@pytest.mark.parametrize(
    ("name", "word"),
    [
        ("undecided", Headline.UNDECIDED),
        ("unstable", Headline.ON_PAPER),
        ("short", Headline.ON_PAPER),
        ("unknown", Headline.ON_PAPER),
        ("short as proved", Headline.ON_PAPER),
    ],
)
def test_a_model_that_was_run_decides(name, word):
    found = judge((GOOD,), (SOUND, LINKS[name]))
    assert found.word is word
    assert found.reason.startswith("sampled: ")
    assert found.witness == PLANT


def test_met_says_the_least_factor():
    found = judge((GOOD,), (link(2.0), link(1.3, guaranteed=1.29), link(GAIN_RESERVE)))
    assert found.word is Headline.MET
    assert "1.100" in found.line
    assert found.line.startswith("met: ")
    assert found.json()["witness"] is None


def test_at_the_reserve_it_is_met_and_just_below_on_paper_only():
    below = float(np.nextafter(GAIN_RESERVE, 0))
    assert judge((), (link(GAIN_RESERVE),)).word is Headline.MET
    assert judge((), (link(below),)).word is Headline.ON_PAPER
    assert judge((), (link(2.0, guaranteed=below),)).word is Headline.ON_PAPER


@pytest.mark.parametrize("order", list(itertools.permutations(range(4))))
def test_precedence_holds_in_any_order(order):
    links = [LINKS["undecided"], LINKS["unstable"], LINKS["short"], SOUND]
    assert judge((CHECKS["violated"],), [links[n] for n in order]).word is Headline.UNDECIDED
    links = [LINKS["unknown"], LINKS["unstable"], LINKS["short"], SOUND]
    assert judge((CHECKS["violated"],), [links[n] for n in order]).word is Headline.NOT_MET
    assert judge((GOOD,), [links[n] for n in order]).word is Headline.ON_PAPER


def test_the_first_of_words_takes_precedence():
    words = list(Headline)
    assert [str(word) for word in words] == ["undecided", "not met", "met on paper only", "met"]
    for first, second in itertools.combinations(words, 2):
        assert Headline.first((second, first)) is first
    assert Headline.first(()) is Headline.MET


def test_published_gains_are_met_on_paper_only_with_the_path_and_fig_5_s_delays(load_boom):
    assert judge_sweep(sweep(load_boom(corners=True))).met  # counted once
    swept = sweep(load_boom(corners=True, twice=True))
    assert swept.satisfied
    found = judge_sweep(swept)
    assert (found.word, found.witness.mass_kg) == (Headline.ON_PAPER, 24500.0)
    assert found.witness.delay_s == pytest.approx(0.0215)
    assert found.reason.startswith("with measurement path: ")
    assert found.because.endswith(found.witness.headline)


def test_published_gains_are_met_where_the_loop_has_a_reserve(load_boom):
    swept = sweep(load_boom(SHORT, corners=True))
    found = judge_sweep(swept)
    assert found.met
    least = min(chain(swept), key=lambda one: one.safe)
    assert 1.2 < least.guaranteed <= least.factor < 1.25
    assert f"{least.guaranteed:.3f}" in found.reason  # the safe side is said


def test_the_machine_counts_as_every_other_model(load_boom):
    swept = sweep(load_boom(SHORT, corners=True))
    machine = Link("nonlinear machine", np.nan, None, stability=Stability.UNSTABLE, note="2 of 6")
    found = judge_sweep(swept, [machine])
    assert (found.word, found.reason) == (Headline.ON_PAPER, "nonlinear machine: 2 of 6")
