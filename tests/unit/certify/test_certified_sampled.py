"""The loop as a sum of shifted values: against the exact one, and what it leaves out."""

from __future__ import annotations

import numpy as np
import pytest
from test_enclosure import GAINS, evaluate

from mptune.certify.climb import figure_at
from mptune.certify.enclosure import SIDES
from mptune.certify.form import curve_of, form_of
from mptune.certify.problem import edges_of
from mptune.certify.sampled import remainder, shifts_up_to, terms_for, truncated_bound

pytestmark = pytest.mark.compiled


def truncated_sensitivity(form, point, terms, monkeypatch):
    monkeypatch.setattr("test_enclosure.TERMS", terms)
    none = np.zeros(SIDES)
    top = evaluate(form, curve_of(1.0), point, none, 1.0, 0.0)[0].value
    return np.sqrt(top / -evaluate(form, curve_of(1.0), point, none, 0.0, 1.0)[0].value)


@pytest.mark.parametrize("kind", GAINS)
@pytest.mark.parametrize("terms", [1, 3, 8, 25])
def test_no_plant_leaves_more_out_than_the_remainder(varied, monkeypatch, kind, terms):
    problem = varied(gains=GAINS[kind], delay=(0.005, 0.03))
    form = form_of(problem, "force_reference", "sampled", "sensitivity_peak")
    edges = edges_of(problem, (0.0, np.pi / problem.period))
    rng = np.random.default_rng(6)
    used = 0.0
    for _ in range(60):
        point = edges[0] + (edges[1] - edges[0]) * rng.uniform(0, 1, SIDES)
        exact = figure_at(form, curve_of(1.0), point)
        found = truncated_sensitivity(form, point, terms, monkeypatch)
        moved = abs(1 / found - 1 / exact)  # at most |L − L_K|
        left_out = remainder(form, edges[1, 1], terms, point[0])
        assert moved <= left_out + 1e-9
        used = max(used, moved / left_out)
    assert used > 1e-3  # of the right order


def test_the_remainder_falls_with_terms_and_rises_with_frequency(published):
    form = form_of(published["section_5_1"], "force_reference", "sampled", "sensitivity_peak")
    by_terms = [remainder(form, 1.0, terms, 50.0) for terms in range(1, 60)]
    assert np.all(np.diff(by_terms) < 0)
    by_omega = [remainder(form, 1.0, 6, omega) for omega in np.linspace(1, 314.2, 60)]
    assert np.all(np.diff(by_omega) >= 0)
    terms = terms_for(form, 1.0, 50.0, 1e-5)
    assert remainder(form, 1.0, terms, 50.0) <= 1e-5 < remainder(form, 1.0, terms - 1, 50.0)


@pytest.mark.parametrize(
    "figure", ["sensitivity_peak", "complementary_peak", "disk_margin", "peak_compliance"]
)
def test_a_bound_of_the_truncated_loop_is_one_of_the_loop(published, figure):
    form = form_of(published["section_5_1"], "force_reference", "sampled", figure)
    rng, left_out, bound = np.random.default_rng(7), 0.01, 5.0
    allowed = truncated_bound(form, bound, left_out, 1.0)
    assert 0.8 * bound < allowed < bound
    gain = rng.normal(size=20000) + 1j * rng.normal(size=20000) - 1
    moved = gain + left_out * np.exp(2j * np.pi * rng.uniform(size=20000))

    def of(loop):
        shares = (1.0, 0.0) if figure == "peak_compliance" else (form.share_s, form.share_t)
        return np.abs((shares[0] + shares[1] * loop) / (1 + loop))

    kept = of(gain) <= allowed
    assert kept.any()
    assert of(moved[kept]).max() <= bound


def test_shifts_stand_in_order():
    np.testing.assert_allclose(shifts_up_to(2, 0.01) * 0.01 / (2 * np.pi), [0, 1, -1, 2, -2])
