"""How far boxes may grow: the study's figures, and boxes that need care."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from mptune.certify.problem import plants_of
from mptune.certify.radius import radius
from mptune.certify.stability import stable_plants

pytestmark = pytest.mark.compiled

# Brackets by a program of its own (a trial before this one was written).
BRACKETS = [
    ("fig_5", "equation_17", 2.293, 2.295),
    ("fig_5", "equation_21", 1.4833, 1.4835),
    ("fig_5", "none", 1.4835, 1.4836),
    ("fig_5", "filters", 0.8335, 0.8341),
    ("fig_5", "sampled", 0.840, 0.841),
    ("section_5_1", "equation_17", 6.037, 6.041),
    ("section_5_1", "equation_21", 2.667, 2.669),
    ("section_5_1", "none", 2.669, 2.670),
    ("section_5_1", "filters", 1.395, 1.396),
    ("section_5_1", "sampled", 1.405, 1.407),
]


@pytest.mark.parametrize(("name", "until", "low", "high"), BRACKETS)
def test_the_published_gains(published, name, until, low, high):
    found = radius(published[name], until)
    print(f"{found.lower:.4f} to {found.upper:.4f}, {found.boxes} boxes, {found.at}")
    assert found.closed
    assert found.upper <= 1.01 * found.lower
    assert found.lower <= high
    assert found.upper >= low
    assert found.at is not None


@pytest.mark.parametrize("until", ["equation_21", "filters"])
def test_closer_on_request(published, until):
    rough, close = (radius(published["fig_5"], until, tolerance=one) for one in (1e-2, 1e-4))
    assert close.closed
    assert close.upper <= (1 + 1e-4) * close.lower
    assert rough.lower <= close.upper
    assert close.lower <= rough.upper


@pytest.mark.parametrize("path", ["none", "filters", "sampled"])
def test_what_fails_above_is_an_unstable_plant_of_the_grown_box(published, path):
    problem = published["section_5_1"]
    found = radius(problem, path)
    grown = problem.box.grown(found.upper, problem.period / 2 if path == "sampled" else 0.0)
    for value, side in zip(
        found.at, (grown.mass, grown.delay, grown.tau_a, grown.tau_b), strict=False
    ):
        assert side[0] * (1 - 1e-12) <= value <= side[1] * (1 + 1e-12)
    assert not stable_plants(problem, plants_of(list(found.at[:4]), problem.share_a), path)[0].any()
    safe = problem.box.grown(found.lower, problem.period / 2 if path == "sampled" else 0.0)
    assert stable_plants(problem, safe.corners(problem.share_a), path)[0].all()


def test_the_measurement_path_is_what_the_equations_do_not_see(published):
    seen = radius(published["fig_5"], "equation_21")
    true, with_path = (radius(published["fig_5"], path) for path in ("none", "filters"))
    assert 0 <= true.lower / seen.lower - 1 < 0.05
    assert with_path.upper < 0.6 * seen.lower


def test_a_box_that_cannot_grow_has_no_limit(varied):
    problem = varied(mass=(24500.0,) * 2, delay=(0.010,) * 2, tau_a=(0.0, 0.0), tau_b=(0.0, 0.0))
    for until in ("equation_17", "none", "filters", "sampled"):
        found = radius(problem, until)
        assert found.lower >= 100
        assert found.upper == math.inf


def test_a_nominal_plant_that_is_unstable_leaves_nothing(varied):
    found = radius(varied(gains={"k_p_vel": 5e6}), "none")
    assert (found.lower, found.upper) == (0.0, 0.0)


def test_the_nominal_plant_may_lie_outside_the_box(varied):
    found = radius(varied(mass=(40e3, 49e3), delay=(0.012, 0.014)), "filters")
    assert found.closed
    assert found.upper <= 1.01 * found.lower


def test_with_the_path_in_the_equations(published):
    without, with_path = (
        radius(published["section_5_1"], "equation_21", path=path) for path in ("none", "filters")
    )
    assert with_path.upper < without.lower


def test_no_hold_fits_into_a_delay_below_half_a_period(varied):
    with pytest.raises(ValueError, match="T_S/2"):
        radius(varied(delay=(0.004, 0.014)), "sampled")


def test_around_an_estimator_the_box_itself_is_where_proofs_begin(estimated):
    """From a nominal plant without lag the proof does not come away: the box is proved alone."""
    lags = {"tau_a": (1e-4, 0.0122), "tau_b": (1e-4, 0.0119)}
    problem = replace(estimated, box=replace(estimated.box, **lags))
    found = radius(problem, "sampled", tolerance=1.0)
    print(f"{found.lower:.4f} to {found.upper:.4f}, {found.boxes} boxes")
    assert found.closed
    assert 1 <= found.lower <= found.upper <= 2 * found.lower
    assert not stable_plants(problem, plants_of(list(found.at[:4]), problem.share_a), "sampled")[
        0
    ].any()
