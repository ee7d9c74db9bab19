"""Discs and bounds against interval arithmetic by another program, in 80 bits, rounded outwards."""

from __future__ import annotations

import numpy as np
import pytest
from certified import (
    FIGURES,
    compare_with_intervals,
    exactly,
    limits,
    random_points,
    random_problem,
    reference,
)

from mptune.certify.bounds import bound
from mptune.certify.enclosure import SIDES
from mptune.certify.form import form_of

pytestmark = pytest.mark.compiled

PROGRAM = reference()
TERMS = 40


@pytest.mark.parametrize("name", FIGURES, ids="-".join)
def test_no_member_of_a_random_box_leaves_its_discs(name):
    rng = np.random.default_rng(FIGURES.index(name))
    for _ in range(4):
        compare_with_intervals(rng, random_problem(rng), name, PROGRAM)


@pytest.mark.parametrize("name", FIGURES, ids="-".join)
def test_the_attained_place_has_the_attained_value_and_none_has_more_than_the_bound(
    published, name
):
    problem = published["section_5_1"]
    found, form = bound(problem, *name), form_of(problem, *name)
    attained, proved = limits(found, form)
    ratio = problem.box.nominal.mass / found.at.mass
    place = np.array([found.at.omega, ratio, *found.at[1:4], 0.0, 0.0])
    none = np.zeros(SIDES)
    low, high = exactly(PROGRAM, form, name, place, none, TERMS)
    assert attained == pytest.approx(low, rel=1e-6 if name[1] != "sampled" else 1e-4)
    assert high <= proved
    for point in random_points(np.random.default_rng(1), problem, name[1], 5):
        assert exactly(PROGRAM, form, name, point, none, 8)[0] <= proved
