"""The tuner ends with a certificate, and no start of its changes the answer."""

from __future__ import annotations

import pytest

from mptune.certify.result import Grounds
from mptune.tune.result import TuneStatus
from mptune.tune.tuner import tune

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

LIGHT = (
    'uncertainty.mass=["3 t", "5 t"]',
    'uncertainty.delay=["6 ms", "12 ms"]',
    'uncertainty.tau_a=["0.1 ms", "5 ms"]',
    'uncertainty.tau_b=["0.1 ms", "9 ms"]',
    "requirements.velocity_ratio=0.7",
    "requirements.position_ratio=0.6",
)
RELEASED = 'requirements.bounds.k_i_pos=["22 1/s^2", "1e5 1/s^2"]'


def test_the_tuned_boom_is_certified_at_its_limits(tuned_boom):
    velocity, position = tuned_boom.sweep.conditions
    assert tuned_boom.status is TuneStatus.OPTIMAL
    assert velocity.grounds is position.grounds is Grounds.CERTIFIED
    assert velocity.certified.bound <= 0.65
    assert 0.479 < position.certified.bound <= 0.48


@pytest.mark.parametrize("k_p_vel", ["85.7 kN s/m", "300 kN s/m"])
def test_where_a_bound_is_released_every_start_leads_to_the_same_optimum(load_boom, k_p_vel):
    """Starts near the study's own gains alone end at the lower bound of K_I, with 1.99 ms."""
    study = load_boom(*LIGHT, RELEASED, f'gains.k_p_vel="{k_p_vel}"', corners=True)
    found = tune(study)
    print(f"from {k_p_vel}: {1e3 * found.figures.tracking:.4f} ms at {found.gains}")
    assert found.status is TuneStatus.OPTIMAL
    assert 1e3 * found.figures.tracking == pytest.approx(1.4176, rel=1e-3)


def test_what_a_certificate_finds_joins_the_search(load_boom):
    """With little lag allowed the worst plants of Eq. 21 lie within the box, off every grid."""
    study = load_boom(*LIGHT, RELEASED, 'requirements.bounds.tau=["0.1 ms", "50 ms"]', corners=True)
    found = tune(study)
    assert found.status is TuneStatus.OPTIMAL
    assert found.sweep.model.plants.number > study.uncertainty.points**4
    assert found.sweep.position.grounds is Grounds.CERTIFIED
    assert found.sweep.position.certified.bound <= 0.6
