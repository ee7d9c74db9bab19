"""Gain, phase and delay margins of whole boxes, at F_ref."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from mptune.certify.margins import MARGINS, margin
from mptune.certify.problem import plants_of
from mptune.certify.result import Stability
from mptune.certify.stability import box_stability, stable_plants
from mptune.loops.family import FamilyLoops
from mptune.robust.margins import family_margins, sampled_margins

pytestmark = pytest.mark.compiled

FORCE = 2


def of_the_corners(problem, path):
    """Return the least gain, phase and delay margin of the box's corners."""
    corners, omega = problem.box.corners(problem.share_a), np.geomspace(1, 300, 800)
    loops = FamilyLoops(corners, problem.gains, problem.path(path))
    if path == "sampled":
        found = sampled_margins(omega, loops, problem.period)
    else:
        found = family_margins(omega, loops)
    return {name: float(getattr(found, name)[FORCE].min()) for name in MARGINS}


@pytest.mark.parametrize("path", ["none", "filters", "sampled"])
@pytest.mark.parametrize("name", MARGINS)
def test_the_published_gains(published, path, name):
    problem = published["section_5_1"]
    found = margin(problem, path, name)
    least = of_the_corners(problem, path)[name]
    print(f"{name} {path}: {found.lower:.5g} to {found.upper:.5g}, corners {least:.5g}")
    assert found.closed
    assert found.upper <= 1.01 * found.lower
    if math.isfinite(least):  # as sampled, the sweep gives no delay margin
        assert found.lower <= least * (1 + 1e-9)
        assert found.upper == pytest.approx(least, rel=0.011)  # the corners hold the worst here


def test_a_gain_margin_is_what_lighter_plants_bear(published):
    problem = published["section_5_1"]
    found = margin(problem, "filters", "gain_margin")
    raised = replace(
        problem, gains=problem.gains._replace(k_p_vel=problem.gains.k_p_vel * found.lower)
    )
    assert box_stability(raised, "filters").status is Stability.STABLE
    beyond = problem.gains._replace(k_p_vel=problem.gains.k_p_vel * found.upper * (1 + 1e-9))
    raised = replace(problem, gains=beyond)
    assert box_stability(raised, "filters").status is Stability.UNSTABLE


def test_a_delay_margin_is_borne(published):
    problem = published["section_5_1"]
    found = margin(problem, "sampled", "delay_margin")
    box = problem.box
    assert box.mass[0] <= found.at.mass <= box.mass[1]
    assert box.delay[0] <= found.at.delay <= box.delay[1]
    worst = [24500.0, 0.014 + found.lower, 0.0122, 0.0119]
    failing = [*found.at[:1], found.at.delay + found.upper, *found.at[2:4]]
    for plant, stable in ((worst, True), (failing, False)):
        one = plants_of(plant, problem.share_a)
        assert stable_plants(problem, one, "sampled")[0].all() == stable


@pytest.mark.parametrize("name", MARGINS)
def test_an_unstable_box_has_no_margin(published, name):
    found = margin(published["fig_5"], "filters", name)
    assert (found.lower, found.upper) == (0.0, 0.0)
    assert found.closed
    assert found.at is not None


def test_without_effort_a_margin_is_open(published):
    found = margin(published["section_5_1"], "filters", "phase_margin", budget=3)
    assert not found.closed
    assert found.lower == 0.0
