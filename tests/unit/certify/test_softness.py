"""A compliance around a state estimator: its numerator enclosed, and what the formula says."""

from __future__ import annotations

import numpy as np
import pytest
from test_enclosure import random_box

from mptune.certify.climb import figure_at
from mptune.certify.enclosure import SIDES, force_over, plant_over
from mptune.certify.figures import coefficients
from mptune.certify.form import curve_of, form_of, scale_of
from mptune.certify.problem import edges_of
from mptune.certify.rows import row_length
from mptune.certify.sampled import ESTIMATED_TERMS, shifts_of
from mptune.certify.softness import enclose_softness, softness
from mptune.loops.broken import SAMPLED
from mptune.loops.family import FamilyLoops
from mptune.robust.running import family_figures

PATHS = ["estimator", "sampled"]


def enclosed(form, centre, half, left, sought):
    """Return F, its slopes and their spreads over a box."""
    shifts = shifts_of(form, ESTIMATED_TERMS if form.loop == SAMPLED else 0)
    terms = len(shifts)
    row, own = np.empty(row_length(terms, 1.0)), np.empty(row_length(terms, 0.0))
    slopes, spreads = np.empty(SIDES), np.empty(SIDES)
    coefficients(form, shifts, curve_of(1.0), centre[0], half[0], row)
    softness(form, shifts, centre[0], half[0], own)
    plant = plant_over(row, shifts, form.share_a, centre, half)
    force = force_over(own, shifts, form.share_a, centre, half)
    found = enclose_softness(
        plant, force, row, own, terms, left, sought, centre, half, slopes, spreads
    )
    return found, slopes, spreads


@pytest.mark.parametrize("path", PATHS)
def test_the_figure_and_its_gradient_are_enclosed(estimated, path):
    form, none = form_of(estimated, "force_reference", path, "peak_compliance"), np.zeros(SIDES)
    rng, edges = np.random.default_rng(5), edges_of(estimated, (0.0, 310.0))
    for _ in range(15):
        centre, half = random_box(rng, edges)
        figure = figure_at(form, curve_of(1.0), centre)
        top = enclosed(form, centre, half, 0.0, 0.0)[0].value
        bottom = top - enclosed(form, centre, half, 0.0, 1.0)[0].value
        assert np.sqrt(top / bottom) == pytest.approx(figure, rel=2e-3)  # folds are left out
        found, slopes, spreads = enclosed(form, centre, half, 0.0, figure)
        reach = float(((np.abs(slopes) + spreads) * half).sum())
        for _ in range(4):
            member = centre + half * rng.uniform(-1, 1, SIDES)
            there, steep, rounding = enclosed(form, member, none, 0.0, figure)
            moved = abs(there.value - found.value)
            assert moved <= found.spread * (1 + 1e-9)
            assert moved <= reach * (1 + 1e-6) + found.error + there.error
            assert np.all(np.abs(steep - slopes) <= spreads + rounding)


def test_what_is_left_out_makes_the_proof_harder_and_never_easier(estimated):
    form = form_of(estimated, "force_reference", "sampled", "peak_compliance")
    rng, edges = np.random.default_rng(6), edges_of(estimated, (0.0, 310.0))
    for _ in range(5):
        centre, half = random_box(rng, edges)
        figure = figure_at(form, curve_of(1.0), centre)
        values = [enclosed(form, centre, half, left, figure)[0].value for left in (0, 1e-4, 1e-2)]
        assert values == sorted(values)


def test_it_is_the_figure_that_a_search_asks(estimated):
    """Sampled polynomials and enclosed sums know nothing of each other."""
    form = form_of(estimated, "force_reference", "sampled", "peak_compliance")
    plants = estimated.box.corners(estimated.share_a)
    loops = FamilyLoops(plants, estimated.gains, estimated.filters)
    found = family_figures(loops, estimated.period, 0.05)
    for n in range(0, plants.number, 5):
        ratio = estimated.box.nominal.mass / plants.mass[n]
        at = (ratio, plants.delay[n], plants.tau_a[n], plants.tau_b[n], 0.0, 0.0)
        place = np.array([found.compliance_frequency[n], *at])
        value = scale_of(form) * figure_at(form, curve_of(1.0), place)
        assert value == pytest.approx(found.peak_compliance[n], rel=1e-9)
