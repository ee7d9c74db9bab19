"""Moves of some milliseconds, short enough for kernels without the compiler, on each machine."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.params.load import load_study
from mptune.verify.verify import cases_of, run_case

THERE = '{distance="2 mm", duration="40 ms", rest="10 ms"}'
BACK = '{distance="-2 mm", duration="40 ms", rest="10 ms"}'
STUDIES = ("boom", "boom-estimator", "boom-adaptive", "four-chamber")


def run(root, name, times, repeats):
    moves = [THERE, BACK] * times
    asked = [f"manoeuvre=[{', '.join(moves)}]", f"verification.repeats={repeats}"]
    study = load_study(root / "studies" / name / "study.toml", asked)
    return run_case(study, cases_of(study)[0], study.study.gains, study.study.feedforward)


@pytest.mark.parametrize("name", STUDIES)
def test_what_is_run_in_two_sets_is_what_is_run_in_one(name, root):
    """Machine, controller and noise go on where the set before left them; energies close."""
    later, whole = run(root, name, times=1, repeats=2), run(root, name, times=2, repeats=1)
    rows = len(later.traces)
    assert len(whole.traces) == 2 * rows
    np.testing.assert_allclose(later.traces, whole.traces[rows:], rtol=1e-9, atol=1e-9)
    assert np.ptp(later.record.position) > 0
    for case in (later, whole):
        assert case.sets[0].energy_residual < 1e-9
        assert case.sets[0].valve_switches > 0
