"""What a verification says: strict JSON whatever happened, and everything that it was run with."""

import json
from dataclasses import replace

import numpy as np
import pytest

from mptune.params.controller import Feedforward
from mptune.params.load import load_study
from mptune.sim.merit import MERITS
from mptune.verify.result import CaseStatus
from mptune.verify.store import to_dataset
from mptune.verify.verify import verify

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

BRIEF = [
    'manoeuvre=[{distance="5 mm", duration="0.2 s", rest="0.1 s"}]',
    "verification.repeats=1",
    "verification.seeds=[1]",
    'verification.masses=["24.5 t"]',
    'verification.oil_bulk_moduli=["1200 MPa"]',
]


@pytest.fixture(scope="module")
def result(study_file):
    ahead = Feedforward.model_validate({"acceleration_mass": "20 t"})
    return verify(load_study(study_file, BRIEF), feedforward=ahead)


def test_json_is_strict_and_holds_every_figure(result):
    said = json.loads(json.dumps(result.json(), allow_nan=False))
    case = said["cases"][0]
    assert {one.key for one in MERITS} <= set(case)
    assert case["broken"] is case["broken_at_s"] is None
    assert case["performance_index_range_ms"] == [case["performance_index_ms"]] * 2


def test_a_case_without_figures_says_none(result):
    lost = replace(result.cases[0], status=CaseStatus.NOT_FINITE, sets=())
    said = json.loads(json.dumps(replace(result, cases=(lost,)).json(), allow_nan=False))
    assert not said["satisfied"]
    assert all(said["cases"][0][one.key] is None for one in MERITS)
    assert said["cases"][0]["performance_index_range_ms"] == [None, None]
    assert lost.badness == np.inf


def test_the_feedforward_is_in_result_json_and_traces(result):
    assert result.feedforward.acceleration_mass == 20e3
    assert result.json()["feedforward"]["acceleration_mass"] == 20e3
    assert json.loads(to_dataset(result).attrs["feedforward"])["acceleration_mass"] == 20e3


def test_the_record_is_the_trace_in_neutral_words(result):
    case = result.cases[0]
    record = case.record
    np.testing.assert_array_equal(record.position, case.traces[:, 2])
    assert record.switches == case.sets[-1].valve_switches > 0
    assert record.travel == pytest.approx(0.005)
    assert record.energies.loss / 5 == pytest.approx(case.figure("energy_loss_j_per_mm"))
