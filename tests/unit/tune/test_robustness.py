"""The disk margin as an objective, and tuning on the loop as it runs with what it asks for."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.certify.result import Grounds
from mptune.errors import InputError
from mptune.params.requirements import Objective
from mptune.robust.result import Status
from mptune.tune.result import TuneStatus
from mptune.tune.tuner import tune

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

SET = {"uncertainty": "section-5-1", "corners": True}
ROBUST = (
    "requirements.velocity_ratio=1.0",
    "requirements.position_ratio=1.0",
    'requirements.peak_compliance="0.317 um/N"',
    'requirements.noise_gain="34.1 MN/m"',
    'objective={kind="robustness", tracking_loop="sampled"}',
)

FEWER = {"xi": (0.9, 0.9), "tau": (5.5e-3, 5.5e-3)}  # free, for speed


def margin_of(result):
    return result.sweep.certificates.of("force_reference", "sampled", "disk_margin")


@pytest.fixture(scope="module")
def robust(load_boom):
    return tune(load_boom(*ROBUST, **SET))


def test_the_disk_margin_is_five_times_the_published_one_and_certified(robust):
    found = margin_of(robust)
    print(f"{found.attained:.4f}, guaranteed {found.bound:.4f}: {robust.gains}")
    assert robust.status is TuneStatus.OPTIMAL
    assert found.closed
    assert found.bound > 0.62
    assert robust.figures.disk_margin == pytest.approx(found.attained, rel=2e-3)
    assert robust.figures_before.disk_margin == pytest.approx(0.12205, rel=1e-3)


def test_what_it_costs_is_kept_within_what_is_allowed(robust):
    checks = {check.key: check for check in robust.sweep.checks}
    assert {check.status for check in checks.values()} == {Status.SATISFIED}
    assert checks["peak_compliance"].grounds is Grounds.CERTIFIED
    assert checks["peak_compliance"].found == pytest.approx(0.317e-6, rel=2e-3)
    assert {"peak_compliance", "noise_gain", "k_i_pos ≥"} <= set(robust.binding)


def test_a_bound_on_the_index_is_kept_and_costs_margin(load_boom, robust):
    free = 'objective.free=["acceleration_mass", "reference_lag"]'
    asked = 'requirements.tracking_index="6 ms"'
    found = tune(load_boom(*ROBUST, free, asked, **SET), extra=FEWER)
    (check,) = [check for check in found.sweep.checks if check.key == "tracking_index"]
    assert found.status is TuneStatus.OPTIMAL
    assert check.status is Status.SATISFIED
    assert check.found == pytest.approx(6e-3, rel=1e-3)
    assert "tracking_index" in found.binding
    assert 0.5 < margin_of(found).bound < margin_of(robust).bound
    assert found.feedforward.acceleration_mass > 30e3


def test_an_index_that_cannot_be_had_is_named(load_boom):
    asked = 'requirements.tracking_index="1 ms"', 'objective.tracking_loop="sampled"'
    result = tune(load_boom(*asked, **SET), structure="p")
    assert result.status is TuneStatus.INFEASIBLE
    assert result.blocking.requirement == "tracking_index"
    assert result.blocking.least_found > 5


def test_margins_that_are_asked_are_what_tracking_is_tuned_to(load_boom):
    asked = (
        'objective.tracking_loop="sampled"',
        "requirements.disk_margin=0.3",
        'requirements.phase_margin="16 deg"',
        'requirements.delay_margin="9 ms"',
        'requirements.noise_gain="34.1 MN/m"',
    )
    found = tune(load_boom(*asked, **SET), structure="pi")
    checks = {check.key: check for check in found.sweep.checks}
    for name in ("disk_margin", "phase_margin", "delay_margin"):
        assert checks[name].status is Status.SATISFIED
        assert checks[name].grounds is Grounds.CERTIFIED
    assert set(found.binding) & {"disk_margin", "phase_margin", "delay_margin"}
    assert found.figures.disk_margin > 2 * found.figures_before.disk_margin


def test_robustness_after_tracking_gives_up_little_of_it(load_boom):
    base = (
        "requirements.gain_margin=1.24",
        'requirements.noise_gain="34.1 MN/m"',
        'objective={kind="tracking", tracking_loop="sampled", keep=0.05}',
    )
    first = tune(load_boom(*base, **SET), structure="pi")
    then = tune(load_boom(*base, 'objective.then=["robustness"]', **SET), structure="pi")
    assert then.figures.tracking <= 1.0501 * first.figures.tracking
    assert then.figures.disk_margin > 1.05 * first.figures.disk_margin


def test_free_and_its_older_name_are_one():
    objective = Objective.model_validate(
        {
            "kind": "tracking",
            "tracking_loop": "sampled",
            "free": ["acceleration_mass"],
            "free_feedforward": ["reference_lag", "acceleration_mass"],
        }
    )
    assert objective.turned == ("acceleration_mass", "reference_lag")
    assert objective.runs
    assert not objective.robust


def test_no_hold_no_disk_margin(load_boom):
    with pytest.raises(InputError, match="hold"):
        load_boom('objective.kind="robustness"', 'uncertainty.delay_as_it_runs=["4 ms", "14 ms"]')


def test_a_weighted_objective_may_hold_robustness(load_boom):
    weights = 'objective={tracking=1.0, robustness=10.0, tracking_loop="sampled"}'
    asked = 'requirements.noise_gain="34.1 MN/m"'
    found = tune(load_boom(weights, asked, **SET), structure="pi")
    assert found.status is not TuneStatus.INFEASIBLE
    assert found.figures.disk_margin > 0.2
    assert np.isfinite(found.figures.tracking)
