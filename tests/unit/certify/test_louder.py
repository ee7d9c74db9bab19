"""The gain as a coordinate of the box: clearance at every gain, and the margin that it proves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from test_enclosure import evaluate, random_box

from mptune.certify.bounds import BUDGET
from mptune.certify.clearance import clearance
from mptune.certify.climb import gain_at
from mptune.certify.enclosure import GAIN, SIDES, enclose, plant_over
from mptune.certify.figures import coefficients
from mptune.certify.form import curve_of, form_of
from mptune.certify.louder import bears
from mptune.certify.margins import margin
from mptune.certify.problem import edges_of, plants_of
from mptune.certify.rows import row_length
from mptune.certify.sampled import ESTIMATED_TERMS, left_out, shifts_of
from mptune.certify.stability import stable_plants

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

PATHS = ["estimator", "sampled"]


@pytest.mark.parametrize("path", PATHS)
def test_the_clearance_holds_at_every_gain_of_the_box(estimated, path):
    form = form_of(estimated, "force_reference", path, "sensitivity_peak")
    shifts = shifts_of(form, ESTIMATED_TERMS if path == "sampled" else 0)
    rng, edges = np.random.default_rng(7), edges_of(estimated, (0.0, 310.0), gain=2.0)
    row, cleared = np.empty(row_length(len(shifts), 1.0)), 0
    for _ in range(40):
        centre, half = random_box(rng, edges)
        coefficients(form, shifts, curve_of(1.0), centre[0], half[0], row)
        plant = plant_over(row, shifts, form.share_a, centre, half)
        least = clearance(plant, row, len(shifts), centre, half)
        cleared += least > 0
        for _ in range(5):
            member = centre + half * rng.uniform(-1, 1, SIDES)
            square = -evaluate_bottom(form, shifts, member)
            assert least <= np.sqrt(square) * (1 + 1e-9)
    assert cleared > 5


def evaluate_bottom(form, shifts, member):
    """Return −|d|² at a member, its gain in the plant's own enclosure."""
    none, row = np.zeros(SIDES), np.empty(row_length(len(shifts), 1.0))
    coefficients(form, shifts, curve_of(1.0), member[0], 0.0, row)
    plant = plant_over(row, shifts, form.share_a, member, none)
    scratch = np.empty((2, SIDES))
    return enclose(plant, row, len(shifts), 0.0, 1.0, member, none, *scratch, 0).value


def test_the_slope_by_the_gain_is_that_of_differences(estimated):
    form = form_of(estimated, "force_reference", "estimator", "sensitivity_peak")
    rng, edges = np.random.default_rng(8), edges_of(estimated, (1.0, 100.0), gain=2.0)
    none = np.zeros(SIDES)
    for _ in range(10):
        place = edges[0] + (edges[1] - edges[0]) * rng.uniform(0, 1, SIDES)
        ends = []
        for sign in (-1, 1):
            moved = place.copy()
            moved[GAIN] += sign * 1e-5
            ends.append(evaluate(form, curve_of(1.0), moved, none, 1.0, 2.0)[0].value)
        _, slopes, _, _ = evaluate(form, curve_of(1.0), place, none, 1.0, 2.0)
        assert slopes[GAIN] == pytest.approx((ends[1] - ends[0]) / 2e-5, rel=1e-4)


@pytest.mark.parametrize("path", PATHS)
def test_every_plant_bears_what_is_proved_and_one_fails_above(estimated, path):
    found = margin(estimated, path, "gain_margin")
    assert found.closed
    assert found.upper <= 1.01 * found.lower
    rng, box = np.random.default_rng(9), estimated.box
    sides = np.array([box.mass, box.delay, box.tau_a, box.tau_b])
    rows = sides[:, 0] + (sides[:, 1] - sides[:, 0]) * rng.integers(0, 3, (60, 4)) / 2
    for factor in (found.lower, 0.5 * (1 + found.lower)):
        gains = estimated.gains._replace(k_p_vel=factor * estimated.gains.k_p_vel)
        louder = replace(estimated, gains=gains)
        stable, decided = stable_plants(louder, plants_of(rows, estimated.share_a), path)
        assert np.all(stable[decided])
    gains = estimated.gains._replace(k_p_vel=found.upper * estimated.gains.k_p_vel)
    one = plants_of([found.at[:4]], estimated.share_a)
    stable, decided = stable_plants(replace(estimated, gains=gains), one, path)
    assert decided[0]
    assert not stable[0]


def test_a_factor_below_the_margin_is_borne_and_one_above_is_not(estimated):
    upper = margin(estimated, "sampled", "gain_margin").upper
    assert bears(estimated, "sampled", upper / 1.03, BUDGET)
    assert not bears(estimated, "sampled", 1.01 * upper, BUDGET)


def test_what_folds_leave_out_is_no_more_than_said(estimated):
    """The sampled polynomials hold all aliases, the enclosed sum a few."""
    form = form_of(estimated, "force_reference", "sampled", "sensitivity_peak")
    shifts = shifts_of(form, ESTIMATED_TERMS)
    rng, edges = np.random.default_rng(10), edges_of(estimated, (0.0, 310.0))
    none, shares = np.zeros(SIDES), []
    for _ in range(30):
        place = edges[0] + (edges[1] - edges[0]) * rng.uniform(0, 1, SIDES)
        place[0] = 10 ** rng.uniform(0, 2.4)
        size = np.sqrt(-evaluate_bottom(form, shifts, place))
        first = np.sqrt(evaluate(form, curve_of(1.0), place, none, 1.0, 0.0)[0].value)
        apart = abs(size / first - abs(1 + gain_at(form, place)))
        rest = left_out(form, place[1], ESTIMATED_TERMS, place[0])
        fall = form.share_a / place[3] + (1 - form.share_a) / place[4]
        most = rest.fixed + min(rest.near, fall * rest.near_rate) + fall * rest.rate
        assert apart <= most * (1 + 1e-9) + 1e-12
        shares.append(apart / most)
    assert max(shares) > 0.02  # it is no bound for its own sake
