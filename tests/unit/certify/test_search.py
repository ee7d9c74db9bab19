"""The search: each way it ends, and that it does not prove what is not so."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.certify.bounds import attain
from mptune.certify.climb import figure_at
from mptune.certify.enclosure import OMEGA, SIDES
from mptune.certify.form import curve_of, form_of
from mptune.certify.problem import edges_of
from mptune.certify.proof import Proof, cover
from mptune.certify.search import ABOVE, OPEN, PROVED, STUCK


@pytest.fixture
def proof(published):
    problem = published["section_5_1"]
    form = form_of(problem, "velocity", "none", "equation_17")
    _, _, edges = attain(problem, form, curve_of(1.0), 1e-3)
    return Proof(form, curve_of(1.0), edges)


def test_above_the_worst_case_everything_is_proved(proof):
    assert proof.run(0.5092, 10_000) == PROVED
    assert 0 < proof.boxes < 10_000


def test_below_it_a_place_is_found_that_lies_above(proof):
    assert proof.run(0.5080, 10_000) == ABOVE
    assert figure_at(proof.form, proof.curve, proof.point) > 0.5080


def test_a_budget_is_kept_and_work_is_not_lost(proof):
    assert proof.run(0.5092, 300) == OPEN
    assert proof.boxes == 300
    assert proof.run(0.5092, 10_000) == PROVED
    total = proof.boxes
    assert proof.run(0.5092, 10_000) == PROVED
    assert proof.boxes == total


@pytest.mark.compiled  # interpreted, it would take minutes
def test_a_zero_of_the_denominator_is_where_a_proof_gets_stuck(published):
    problem = published["fig_5"]  # holds the boundary of stability, with the path
    form = form_of(problem, "force_reference", "filters", "sensitivity_peak")
    proof = Proof(form, curve_of(1.0), edges_of(problem, (0.0, 300.0)))
    assert proof.run_nonzero(200_000) == STUCK
    assert figure_at(form, curve_of(1.0), proof.point) > 1e8


def test_a_box_is_covered_by_octaves_and_cut_at_the_corners_of_a_curve(published):
    edges = edges_of(published["fig_5"], (0.0, 256.0))
    parts = cover(edges, np.array([[10.0, 0.7], [50.0, 0.5]]))
    starts, ends = parts[:, 0, OMEGA], parts[:, 1, OMEGA]
    assert starts[0] == 0
    assert ends[-1] == 256
    np.testing.assert_array_equal(starts[1:], ends[:-1])
    assert {10.0, 50.0, 128.0} <= set(ends)
    np.testing.assert_array_equal(
        parts[:, :, 1:], np.broadcast_to(edges[:, 1:], (len(parts), 2, SIDES - 1))
    )


def test_a_box_of_one_frequency_is_one_part(published):
    edges = edges_of(published["fig_5"], (40.0, 40.0))
    np.testing.assert_array_equal(cover(edges, np.zeros((0, 2))), edges[None])
