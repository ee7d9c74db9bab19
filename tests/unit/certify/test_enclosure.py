"""F and its gradient over boxes: every plant and frequency of a box lies in what is enclosed."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.certify.clearance import clearance
from mptune.certify.climb import figure_at
from mptune.certify.enclosure import OMEGA, SIDES, enclose, plant_over
from mptune.certify.figures import coefficients
from mptune.certify.form import COMPLIANCE, curve_of, form_of
from mptune.certify.problem import edges_of
from mptune.certify.rows import row_length
from mptune.certify.sampled import shifts_of

FIGURES = [
    ("velocity", "none", "equation_17"),
    ("velocity", "filters", "equation_17"),
    ("position", "none", "equation_21"),
    ("position", "filters", "equation_21"),
    ("velocity", "filters", "disk_margin"),
    ("position", "filters", "sensitivity_peak"),
    ("position", "none", "complementary_peak"),
    ("force_reference", "none", "sensitivity_peak"),
    ("force_reference", "filters", "disk_margin"),
    ("force_reference", "sampled", "sensitivity_peak"),
    ("force_reference", "sampled", "complementary_peak"),
    ("force_reference", "none", "peak_compliance"),
    ("force_reference", "filters", "peak_compliance"),
    ("force_reference", "sampled", "peak_compliance"),
]
GAINS = {
    "published": {},
    "no integral term": {"k_i_pos": 0.0},
    "no proportional term": {"k_p_pos": 0.0},
    "velocity loop alone": {"k_p_pos": 0.0, "k_i_pos": 0.0},
    "a light notch": {"xi": 1e-4},
}
TERMS = 40  # of the sampled loop: 2e-6 of its gain are left out


def evaluate(form, curve, centre, half, num, den):
    shifts = shifts_of(form, TERMS if form.loop == 3 else 0)
    row = np.empty(row_length(len(shifts), form.path.estimator_mass))
    slopes, spreads = np.empty(SIDES), np.empty(SIDES)
    coefficients(form, shifts, curve, centre[OMEGA], half[OMEGA], row)
    plant = plant_over(row, shifts, form.share_a, centre, half)
    power = 2 if form.figure == COMPLIANCE else 0
    found = enclose(plant, row, len(shifts), num, den, centre, half, slopes, spreads, power)
    clear = clearance(plant, row, len(shifts), centre, half)
    return found, slopes, spreads, clear


def quotient(form, curve, centre, half):
    """Return the figure at the centre, and the least and the largest that the discs allow."""
    top = evaluate(form, curve, centre, half, 1.0, 0.0)[0]
    bottom = evaluate(form, curve, centre, half, 0.0, 1.0)[0]
    most = np.inf if -bottom.value <= bottom.spread else -bottom.value - bottom.spread
    low = max(top.value - top.spread, 0.0) / (-bottom.value + bottom.spread)
    high = (top.value + top.spread) / most if np.isfinite(most) else np.inf
    return np.sqrt(max(top.value, 0.0) / -bottom.value), np.sqrt(low), np.sqrt(high)


def random_box(rng, edges):
    """Return centre and half widths of a box, sides from narrow to as wide as the whole."""
    width = (edges[1] - edges[0]) * 10 ** rng.uniform(-4, 0, SIDES)
    low = edges[0] + (edges[1] - edges[0] - width) * rng.uniform(0, 1, SIDES)
    low[OMEGA] = edges[1, OMEGA] * 10 ** rng.uniform(-3, 0)
    width[OMEGA] = min(width[OMEGA], 20.0)
    low[OMEGA] = min(low[OMEGA], edges[1, OMEGA] - width[OMEGA])
    return low + width / 2, width / 2


@pytest.mark.compiled
@pytest.mark.parametrize("kind", GAINS)
@pytest.mark.parametrize("name", FIGURES, ids="-".join)
def test_the_figure_of_every_member_is_enclosed(varied, name, kind):
    if name[2] == "peak_compliance" and kind == "velocity loop alone":
        pytest.skip("where the position is not fed back a load moves it without end")
    problem = varied(gains=GAINS[kind], delay=(0.005, 0.03), mass=(15e3, 60e3))
    form, curve = form_of(problem, *name), curve_of(1.0)
    rng = np.random.default_rng(1)
    edges = edges_of(problem, (0.0, 310.0))
    for _ in range(40):
        centre, half = random_box(rng, edges)
        at_centre, low, high = quotient(form, curve, centre, half)
        exact = figure_at(form, curve, centre)
        assert at_centre == pytest.approx(exact, rel=1e-4 if form.loop == 3 else 1e-7, abs=1e-7)
        for _ in range(10):
            member = centre + half * rng.uniform(-1, 1, SIDES)
            value = figure_at(form, curve, member)
            slack = 1e-4 * value if form.loop == 3 else 1e-9 * value + 1e-12
            assert low - slack <= value <= high + slack


@pytest.mark.compiled
@pytest.mark.parametrize("name", FIGURES, ids="-".join)
def test_the_gradient_is_that_of_differences_and_holds_over_the_box(varied, name):
    problem = varied(delay=(0.006, 0.03), mass=(15e3, 60e3))
    form = form_of(problem, *name)
    curve = curve_of(((10.0, 0.7), (100.0, 0.4))) if "equation" in name[2] else curve_of(1.0)
    rng = np.random.default_rng(2)
    edges = edges_of(problem, (12.0, 95.0), phase=0.2)
    none = np.zeros(SIDES)
    for _ in range(15):
        centre, half = random_box(rng, edges)
        centre[OMEGA], half[OMEGA] = rng.uniform(15, 90), rng.uniform(0, 2)
        _, slopes, spreads, _ = evaluate(form, curve, centre, half, 1.0, 1.7)
        member = centre + half * rng.uniform(-1, 1, SIDES)
        _, of_member, rounding, _ = evaluate(form, curve, member, none, 1.0, 1.7)
        assert np.all(np.abs(of_member - slopes) <= spreads + rounding)
        size = max(abs(evaluate(form, curve, member, none, *one)[0].value) for one in WEIGHTS)
        for i in range(SIDES):
            step = np.zeros(SIDES)
            step[i] = 1e-4 * (edges[1, i] - edges[0, i])
            ahead, behind = (
                evaluate(form, curve, member + way * step, none, 1.0, 1.7)[0].value
                for way in (1, -1)
            )
            difference = (ahead - behind) / 2
            assert difference == pytest.approx(of_member[i] * step[i], rel=1e-4, abs=1e-8 * size)


WEIGHTS = ((1.0, 0.0), (0.0, 1.0))


@pytest.mark.compiled
@pytest.mark.parametrize("path", ["none", "filters", "sampled"])
def test_the_clearance_is_below_every_members_denominator(varied, path):
    problem = varied(delay=(0.006, 0.02))
    form, curve = form_of(problem, "force_reference", path, "sensitivity_peak"), curve_of(1.0)
    rng = np.random.default_rng(3)
    edges = edges_of(problem, (1.0, 150.0), phase=0.3)
    positive = 0
    for _ in range(60):
        centre, half = random_box(rng, edges)
        half = np.minimum(half, 0.05 * (edges[1] - edges[0]))
        clear = evaluate(form, curve, centre, half, 0.0, 1.0)[3]
        positive += clear > 0
        for _ in range(8):
            member = centre + half * rng.uniform(-1, 1, SIDES)
            value = -evaluate(form, curve, member, np.zeros(SIDES), 0.0, 1.0)[0].value
            assert clear <= np.sqrt(max(value, 0.0)) * (1 + 1e-9)
    assert positive > 20


@pytest.mark.compiled
@pytest.mark.parametrize("side", range(SIDES))
@pytest.mark.parametrize(
    "name",
    [
        ("velocity", "none", "equation_17"),
        *(("force_reference", path, "sensitivity_peak") for path in ("none", "filters", "sampled")),
    ],
    ids="-".join,
)
def test_one_side_alone_is_followed_to_both_of_its_ends(varied, name, side):
    problem = varied(delay=(0.005, 0.03), tau_a=(0.0, 0.02), tau_b=(0.0, 0.02))
    form = form_of(problem, *name)
    curve, none = curve_of(1.0), np.zeros(SIDES)
    rng = np.random.default_rng(side)
    edges = edges_of(problem, (0.0, 150.0), phase=0.5)
    for _ in range(150):
        centre = edges[0] + (edges[1] - edges[0]) * rng.uniform(0, 1, SIDES)
        half = np.zeros(SIDES)
        half[side] = (edges[1, side] - edges[0, side]) * 10 ** rng.uniform(-3, -1.3)
        centre[side] = max(centre[side], edges[0, side] + half[side])
        box, slopes, spreads, clear = evaluate(form, curve, centre, half, 0.01, 1.0)
        for way in (-1, -0.5, 0.5, 1):
            member = centre + way * half
            found, of_member, rounding, _ = evaluate(form, curve, member, none, 0.01, 1.0)
            assert abs(found.value - box.value) <= box.spread + found.error
            assert np.all(np.abs(of_member - slopes) <= spreads + rounding)
            reach = (abs(slopes[side]) + spreads[side]) * abs(way) * half[side]
            assert abs(found.value - box.value) <= reach + found.error + box.error
            denominator = -evaluate(form, curve, member, none, 0.0, 1.0)[0].value
            assert clear <= np.sqrt(max(denominator, 0.0)) * (1 + 1e-12)


def test_rounding_at_a_point_is_all_that_is_left(varied):
    problem = varied()
    form, curve = form_of(problem, "position", "filters", "equation_21"), curve_of(1.0)
    point = np.array([38.0, 1.0, 0.013, 0.0122, 0.0119, 0.0, 0.0])
    found, _, spreads, _ = evaluate(form, curve, point, np.zeros(SIDES), 1.0, 0.15)
    assert 0 < found.error <= found.spread < 1e-10 * abs(found.value)
    assert np.all(spreads > 0)
