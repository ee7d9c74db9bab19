"""Requirements on the machine: the worst machine decides, in SI, and a lost one has no figures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mptune.params.load import load_study
from mptune.robust.result import Status
from mptune.sim.judge import SetFigures
from mptune.verify.checks import machine_checks
from mptune.verify.result import CaseResult, CaseStatus, VerifyResult

ASKED = (
    'requirements.performance_index="16 ms"',
    'requirements.final_error="0.5 mm"',
    'requirements.force_error="40 kN^2 s"',
)
UNKNOWN = float("nan")


def one_set(index, force_error, final):
    return SetFigures(
        index, 19.0, 19.0, force_error, final, 111.0, 840, 50.0, 0.6, 15.9, 1e-3, 3, 0.0
    )


def case_of(mass, *sets):
    return CaseResult(
        mass_kg=mass, valve_delay_s=(5e-3, 8e-3), oil_bulk_modulus_pa=1.2e9, load_force_n=9700.0,
        seed=1, status=CaseStatus.STABLE, broken="", broken_at_s=UNKNOWN, sets=sets,
        record=None, traces=np.zeros((0, 15)),
    )  # fmt: skip


@pytest.fixture(scope="module")
def verified(study_file):
    study = load_study(study_file, ASKED)
    light = case_of(24.5e3, one_set(12.0, 30.0, 0.2), one_set(14.0, 34.0, 0.6))
    heavy = case_of(49e3, one_set(15.0, 44.0, 0.3), one_set(16.0, 40.0, 0.4))
    inner = study.study
    return VerifyResult(study, inner.gains, inner.feedforward, (light, heavy))


def test_the_worst_machine_decides(verified):
    checks = {check.key: check for check in machine_checks(verified)}
    assert list(checks) == ["performance_index", "final_error", "force_error"]
    index, final, force = checks.values()
    assert index.found == pytest.approx(15.5e-3)  # mean of the heavy one's sets, in s
    assert final.found == pytest.approx(0.6e-3)  # largest of the light one's, in m
    assert force.found == pytest.approx(42e6)  # N² s
    assert [check.status.value for check in checks.values()] == ["satisfied", *["violated"] * 2]
    assert "49 t" in index.label
    assert "24.5 t" in final.label
    assert index.limit == "≤ 0.016 s"


def test_a_machine_that_is_not_stable_has_none_of_them(verified):
    lost = replace(verified.cases[1], status=CaseStatus.LIMIT_CYCLE)
    checks = machine_checks(replace(verified, cases=(verified.cases[0], lost)))
    assert {check.status for check in checks} == {Status.UNSTABLE}
    assert all(np.isnan(check.found) and "49 t" in check.label for check in checks)


def test_only_what_is_asked_is_checked(verified, study_file):
    plain = replace(verified, study=load_study(study_file))
    assert machine_checks(plain) == ()
    assert {check.status for check in machine_checks(replace(verified, cases=()))} == {
        Status.NOT_EVALUATED
    }
