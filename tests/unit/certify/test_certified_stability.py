"""Stability of whole boxes: proved, refuted by a witness, or open."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.certify.problem import plants_of
from mptune.certify.result import Stability
from mptune.certify.stability import box_stability, stable_plants

pytestmark = pytest.mark.compiled

VERDICTS = [
    ("fig_5", "none", Stability.STABLE),
    ("fig_5", "filters", Stability.UNSTABLE),
    ("fig_5", "sampled", Stability.UNSTABLE),
    ("section_5_1", "none", Stability.STABLE),
    ("section_5_1", "filters", Stability.STABLE),
    ("section_5_1", "sampled", Stability.STABLE),
]


@pytest.mark.parametrize(("name", "path", "status"), VERDICTS)
def test_the_published_gains(published, name, path, status):
    found = box_stability(published[name], path)
    assert found.status is status
    assert (found.witness is not None) == (status is Stability.UNSTABLE)
    assert found.suspect is None


@pytest.mark.parametrize("path", ["none", "filters"])
def test_the_velocity_loop_alone(published, path):
    assert box_stability(published["fig_5"], path, "velocity").status is Stability.STABLE


@pytest.mark.parametrize("path", ["filters", "sampled"])
def test_a_witness_is_unstable(published, hidden, path):
    for problem in (published["fig_5"], hidden):
        witness = box_stability(problem, path).witness
        stable, decided = stable_plants(
            problem, plants_of(list(witness[:4]), problem.share_a), path
        )
        assert decided.all()
        assert not stable.any()


@pytest.mark.parametrize("path", ["filters", "sampled"])
def test_plants_that_no_corner_shows_to_be_unstable(hidden, path):
    stable, _ = stable_plants(hidden, hidden.box.corners(hidden.share_a), path)
    assert stable.all()
    found = box_stability(hidden, path)
    assert found.status is Stability.UNSTABLE
    assert 0 < found.witness.tau_b < 0.24
    assert 0 < found.boxes < 5000


@pytest.mark.parametrize("path", ["none", "filters", "sampled"])
def test_all_plants_of_a_box_that_was_proved_stable_are(published, path):
    problem = published["section_5_1"]
    box, rng = problem.box, np.random.default_rng(5)
    sides = np.array([box.mass, box.delay, box.tau_a, box.tau_b]).T
    plants = plants_of(
        sides[0] + (sides[1] - sides[0]) * rng.uniform(0, 1, (300, 4)), problem.share_a
    )
    assert stable_plants(problem, plants, path)[0].all()


def test_without_effort_a_box_stays_undecided(published):
    found = box_stability(published["section_5_1"], "filters", budget=5)
    assert found.status is Stability.UNDECIDED
    assert found.witness is None
    assert found.suspect.mass >= published["section_5_1"].box.mass[0]


def test_an_integral_term_alone_is_unstable_everywhere(varied):
    found = box_stability(varied(gains={"k_p_pos": 0.0}), "none")
    assert found.status is Stability.UNSTABLE
