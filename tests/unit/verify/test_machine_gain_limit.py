"""The last link: how far the gain may rise on the nonlinear machine."""

import pytest

from mptune.robust.chain import chain
from mptune.robust.sweep import sweep
from mptune.verify.gain_limit import MACHINE, machine_gain_limit

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
    study = light.study
    link = machine_gain_limit(
        light, study.gains, study.feedforward, lambda _stage, share: shares.append(share)
    )
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
    link = machine_gain_limit(light, gains, light.study.feedforward)
    print(f"{link.name}: {link.factor:.3f}")
    assert 0.4 < link.factor < 0.75
