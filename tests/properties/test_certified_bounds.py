"""Certified bounds of random families with random gains: no plant exceeds them at any frequency."""

from __future__ import annotations

import math

import numpy as np
import pytest
from certified import FIGURES, largest_value, limits, random_points, random_problem
from hypothesis import given, settings
from hypothesis import strategies as st

from mptune.certify.bounds import bound
from mptune.certify.form import curve_of, form_of
from mptune.certify.problem import plants_of
from mptune.certify.result import Stability
from mptune.certify.stability import box_stability, stable_plants

pytestmark = pytest.mark.compiled

SEEDS = st.integers(0, 2**32 - 1)


@settings(max_examples=12)
@given(SEEDS)
def test_no_plant_exceeds_a_bound(seed):
    rng = np.random.default_rng(seed)
    problem = random_problem(rng)
    for name in FIGURES:
        found = bound(problem, *name)
        attained, proved = limits(found, form_of(problem, *name))
        assert attained <= proved
        if not math.isfinite(proved):
            continue
        points = random_points(rng, problem, name[1], 100)
        highest = largest_value(form_of(problem, *name), curve_of(1.0), points)
        assert highest <= proved * (1 + 1e-12)
        assert highest <= attained * (1 + 1e-4) + 1e-3 or not found.closed


@settings(max_examples=15)
@given(SEEDS)
def test_a_verdict_on_a_box_is_that_of_its_plants(seed):
    rng = np.random.default_rng(seed)
    problem = random_problem(rng)
    for path in ("none", "filters", "sampled"):
        found = box_stability(problem, path)
        points = random_points(rng, problem, path, 40)
        points[:, 1] = problem.box.nominal.mass / points[:, 1]
        stable, decided = stable_plants(problem, plants_of(points[:, 1:5], problem.share_a), path)
        if found.status is Stability.STABLE:
            assert stable[decided].all()
        if found.status is Stability.UNSTABLE:
            assert not stable_plants(
                problem, plants_of(list(found.witness[:4]), problem.share_a), path
            )[0].any()
