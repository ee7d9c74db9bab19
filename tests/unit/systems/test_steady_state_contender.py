"""This machine deciding on settled pressures, as ``[systems.steady_state]`` weighs it."""

from __future__ import annotations

import pytest

from mptune.job.systems import this_machine
from mptune.params.load import load_study
from mptune.systems.compare import load_cases
from mptune.verify.verify import Case, run_case

SHORT = (
    (
        'manoeuvre=[{distance="10 mm", duration="0.4 s", rest="0.2 s"}, '
        '{distance="-10 mm", duration="0.4 s", rest="0.2 s"}]'
    ),
    "systems.repeats=2",
    'verification.masses=["49 t"]',
    'systems.steady_state.weight_loss="200 N/J"',
)
DECISION = (
    'controller.force_model="steady-state"',
    'controller.weight_switching="400 N"',
    'controller.weight_loss="200 N/J"',
    'controller.weight_compression="60 N/J"',
)


@pytest.mark.compiled
def test_it_is_the_study_with_the_other_decision_and_the_same_gains(study_file):
    study = load_study(study_file, SHORT)
    mine = {one.key: one for one in this_machine(study, study.study.gains, study.study.feedforward)}
    (case,) = load_cases(study)
    found = mine["steady_state"].literature.run(case, 1.0)
    other = load_study(study_file, (*SHORT, *DECISION, "verification.repeats=2"))
    delay = other.study.verification.delay_ranges()[0]
    wanted = run_case(
        other,
        Case(case.mass, delay, case.oil_bulk_modulus, case.load_force, case.seed),
        other.study.gains,
        other.study.feedforward,
    )
    assert found.sets == wanted.sets
    assert found.sets != mine["this_machine"].literature.run(case, 1.0).sets
    assert [one.name for one in mine["steady_state"].others] == ["tuned"]
    assert study.study.controller.force_model == "dynamic"


def test_a_study_without_it_has_one_system_fewer(boom):
    systems = boom.study.systems.model_copy(update={"steady_state": None})
    without = boom.model_copy(update={"study": boom.study.model_copy(update={"systems": systems})})
    gains, ahead = boom.study.gains, boom.study.feedforward
    keys = {one.key for one in this_machine(boom, gains, ahead)}
    assert keys - {one.key for one in this_machine(without, gains, ahead)} == {"steady_state"}
