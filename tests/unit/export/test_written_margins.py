"""Margins of exactly what was written."""

import pytest
from target import gains_of

from mptune.export.as_written import Written
from mptune.export.formats import Precision
from mptune.export.margins import written_margins
from mptune.job.export import prepare
from mptune.robust.result import Status


def names(checks):
    return [check.key for check in checks]


def test_exact_numbers_keep_every_requirement(controller):
    assert controller.margins.broken == ()
    assert controller.margins.satisfied
    assert controller.margins.written.velocity.worst_ratio == pytest.approx(0.5103, abs=1e-4)


def test_single_precision_hardly_moves_the_ratios(controller, single):
    for one, other in zip(
        controller.margins.written.conditions, single.margins.written.conditions, strict=True
    ):
        assert other.worst_ratio == pytest.approx(one.worst_ratio, rel=1e-4)
    assert single.margins.written.gains != controller.margins.written.gains


def test_rounding_that_breaks_a_requirement_is_named(load_boom):
    """681 kN s/m keep a ratio of 0.635 that the 700 kN s/m of one digit do not."""
    study = load_boom("gains.k_p_vel=681 kN s/m", "requirements.velocity_ratio=0.635", corners=True)
    exact = prepare(study, gains_of(study), Precision.DOUBLE)
    rounded = prepare(study, gains_of(study), Precision.DOUBLE, digits=1)
    assert exact.margins.broken == ()
    assert "velocity_ratio" in names(rounded.margins.broken)


def test_what_failed_before_is_not_broken_by_writing(load_boom):
    study = load_boom("requirements.velocity_ratio=0.6", corners=True)
    found = prepare(study, gains_of(study), Precision.DOUBLE)
    assert found.margins.broken == ()
    assert not found.margins.satisfied
    assert not found.trusted


def test_a_bound_on_a_gain_counts_as_written(load_boom):
    study = load_boom(corners=True)  # its K_I,pos of 22 1/s² stands on its bound
    assert "k_i_pos" in names(prepare(study, gains_of(study), Precision.FLOAT).margins.checks)
    rounded = prepare(study, gains_of(study), Precision.DOUBLE, digits=1)  # 20 1/s²
    assert names(rounded.margins.broken) == ["k_i_pos"]


def test_the_written_filter_counts_where_the_model_holds_it(load_boom):
    study = load_boom('model.measurement_path="filters"', corners=True)
    gains = study.study.gains
    ratios = [
        written_margins(study, gains, Written(gains, time, 0.0)).written.velocity.worst_ratio
        for time in (12e-3, 13e-3)
    ]
    assert ratios[0] != ratios[1]


def test_coefficients_far_from_any_gains_are_not_vouched_for(study):
    gains = study.study.gains
    margins = written_margins(study, gains, Written(gains, 12e-3, 1e-3))
    (check,) = margins.broken
    assert "coefficients" in check.key
    assert check.status is Status.VIOLATED
