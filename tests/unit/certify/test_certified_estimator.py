"""Figures around a state estimator: enclosed, proved, and no box proved by an easier face."""

from __future__ import annotations

import numpy as np
import pytest
from test_enclosure import quotient, random_box

from mptune.certify.bounds import aimed, bound
from mptune.certify.climb import figure_at
from mptune.certify.enclosure import OMEGA, RATIO, SIDES, TAU_A, TAU_B
from mptune.certify.form import curve_of, form_of, scale_of
from mptune.certify.problem import edges_of
from mptune.certify.search import NO_REST, _collapse

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

FIGURES = ["sensitivity_peak", "complementary_peak", "disk_margin", "peak_compliance"]
PATHS = ["estimator", "sampled"]


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("figure", FIGURES[:-1])  # the last: ``test_softness``
def test_the_figure_of_every_member_is_enclosed(estimated, path, figure):
    form, curve = form_of(estimated, "force_reference", path, figure), curve_of(1.0)
    rng, edges = np.random.default_rng(1), edges_of(estimated, (0.0, 310.0))
    folds = 2e-3 if path == "sampled" else 1e-9  # left out of the sum
    for _ in range(40):
        centre, half = random_box(rng, edges)
        at_centre, low, high = quotient(form, curve, centre, half)
        exact = figure_at(form, curve, centre)
        assert at_centre == pytest.approx(exact, rel=max(folds, 1e-7), abs=1e-7)
        for _ in range(10):
            member = centre + half * rng.uniform(-1, 1, SIDES)
            value = figure_at(form, curve, member)
            assert low - folds * value - 1e-12 <= value <= high + folds * value + 1e-12


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("figure", FIGURES)
def test_no_member_is_above_what_is_proved(estimated, path, figure):
    found = bound(estimated, "force_reference", path, figure)
    assert found.closed
    form, curve = form_of(estimated, "force_reference", path, figure), curve_of(1.0)
    rng, edges = np.random.default_rng(2), edges_of(estimated, (0.0, 310.0))
    members = edges[0] + (edges[1] - edges[0]) * rng.uniform(0, 1, (4000, SIDES))
    sides = rng.integers(0, 2, (4000, SIDES))
    members[2000:] = np.where(sides, edges[0], edges[1])[2000:]
    members[:, OMEGA] = rng.uniform(1, 60, 4000)
    highest = scale_of(form) * max(figure_at(form, curve, one) for one in members)
    if figure == "disk_margin":
        assert found.bound <= found.attained <= 1 / highest * (1 + 1e-9)
        assert found.attained == pytest.approx(1 / highest, rel=0.05)
    else:
        assert highest * (1 - 1e-9) <= found.attained <= found.bound
        assert found.attained == pytest.approx(highest, rel=0.05)


@pytest.mark.parametrize("figure", FIGURES)
def test_a_limit_between_both_values_is_proved_and_one_that_fails_is_not(estimated, figure):
    found = bound(estimated, "force_reference", "sampled", figure)
    inside = found.attained + 0.7 * (found.bound - found.attained)
    closer = aimed(estimated, found, inside)
    assert (closer.bound, closer.attained) == (inside, found.attained)
    assert closer.boxes > found.boxes
    outside = found.attained - 0.1 * (found.bound - found.attained)
    assert aimed(estimated, found, outside).bound == found.bound


@pytest.mark.parametrize("time", [0.0, 0.05])
def test_a_face_on_which_less_is_asked_proves_nothing_of_the_box(time):
    """Less is left out of the loop where lags are long; a compliance weighs more with less mass."""
    spreads = np.zeros(SIDES)
    for side, eased in ((TAU_A, 1.0), (TAU_B, 1.0), (RATIO, 1.0), (OMEGA, -1.0)):
        for slope in (1.0, -1.0):
            low, high, slopes = np.zeros(SIDES), np.zeros(SIDES), np.zeros(SIDES)
            high[side], slopes[side] = 1.0, slope
            rest = NO_REST._replace(rate=1e-5, time=time)
            stays = slope == eased and (time > 0 or side in {TAU_A, TAU_B})
            assert _collapse(low, high, slopes, spreads, rest) != stays
            assert (low[side] == high[side]) != stays
