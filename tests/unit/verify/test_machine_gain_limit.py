"""The last link: how far the gain may rise on the nonlinear machine."""

from types import SimpleNamespace

import pytest

from mptune.robust.chain import chain
from mptune.robust.sweep import sweep
from mptune.verify import gain_limit as searched
from mptune.verify.gain_limit import MACHINE, machine_gain_limit
from mptune.verify.verify import verify

pytestmark = pytest.mark.compiled  # interpreted, it would take hours

LIGHT = (
    "verification.repeats=3",
    "verification.seeds=[1]",
    'verification.masses=["24500 kg"]',
)


@pytest.fixture(scope="module")
def light(load_boom):
    return load_boom(*LIGHT, uncertainty="section-5-1", corners=True)


def test_the_light_machine_bears_about_half_as_much_again(light):
    """The linear chain ends at 1.24; a limit cycle is known between 1.5 and 1.75."""
    shares = []
    link = machine_gain_limit(verify(light), lambda _stage, share: shares.append(share))
    print(f"{link.name}: {link.factor:.3f}")
    assert link.name == MACHINE
    assert 1.3 < link.factor < 1.75
    assert link.at is None
    assert shares == sorted(shares)
    assert 0 < shares[0] <= shares[-1] <= 1
    sampled = chain(sweep(light))[-1]
    assert sampled.factor == pytest.approx(1.24, abs=0.005)


def test_a_gain_that_is_too_high_gets_a_factor_below_one(light):
    gains = light.study.gains.model_copy(update={"k_p_vel": 1.9e6})
    link = machine_gain_limit(verify(light, gains))
    print(f"{link.name}: {link.factor:.3f}")
    assert 0.4 < link.factor < 0.75


def test_a_trial_ends_with_the_machine_that_fails_which_the_next_begins_with(light, monkeypatch):
    """Nor is run what the verification has run already."""
    asked = []

    def run_case(_study, case, gains, _fed, *, while_stable):
        assert while_stable
        asked.append((case.oil_bulk_modulus, gains.k_p_vel / light.study.gains.k_p_vel))
        failed = case.oil_bulk_modulus == 1.4e9 and asked[-1][1] > 1.5
        return SimpleNamespace(stable=not failed)

    class AsIs(SimpleNamespace):
        satisfied = True

    monkeypatch.setattr(searched, "run_case", run_case)
    monkeypatch.setattr(searched, "Parallel", lambda **_: lambda jobs: [f(*a) for f, a, _ in jobs])
    known = [SimpleNamespace(seed=1, stable=True)]
    own = light.study
    link = machine_gain_limit(AsIs(study=light, gains=own.gains, feedforward=None, cases=known))
    assert 1.47 < link.factor <= 1.5
    assert {factor for _, factor in asked} >= {2.0}
    assert 1.0 not in {factor for _, factor in asked}
    too_much = [(oil, factor) for oil, factor in asked if factor > 1.5]
    assert too_much[0][0] == 0.8e9  # in the study's order at first
    assert all(oil == 1.4e9 for oil, factor in too_much if factor < 2.0)
