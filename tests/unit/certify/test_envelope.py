"""A figure over frequency: never exceeded, and its largest value the figure's own."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.certify.bounds import bound
from mptune.certify.climb import figure_at
from mptune.certify.enclosure import SIDES
from mptune.certify.envelope import envelope
from mptune.certify.form import curve_of, form_of
from mptune.certify.problem import edges_of

pytestmark = pytest.mark.compiled

NAMES = [
    ("velocity", "none", "equation_17"),
    ("position", "filters", "equation_21"),
    ("force_reference", "none", "sensitivity_peak"),
    ("force_reference", "sampled", "complementary_peak"),
]


@pytest.mark.parametrize("name", NAMES, ids="-".join)
def test_no_plant_exceeds_the_envelope(published, name):
    problem = published["section_5_1"]
    omega = np.geomspace(1.0, 250.0, 61)
    found = envelope(problem, *name, omega)
    assert found.closed.all()
    assert np.all(found.attained <= found.bound)
    form = form_of(problem, *name)
    edges = edges_of(problem, (1.0, 250.0))
    rng = np.random.default_rng(9)
    points = edges[0] + (edges[1] - edges[0]) * rng.uniform(-0.5, 1.5, (3000, SIDES)).clip(0, 1)
    points[:, 0] = 10 ** rng.uniform(0, np.log10(250), 3000)
    values = np.array([figure_at(form, curve_of(1.0), point) for point in points])
    assert np.all(values <= found.bound[np.searchsorted(omega, points[:, 0]) - 1])
    whole = bound(problem, *name)
    assert found.attained.max() == pytest.approx(whole.attained, rel=1e-3)


def test_where_a_plant_is_on_the_boundary_of_stability_there_is_no_bound(published):
    omega = np.linspace(10.0, 60.0, 26)
    found = envelope(published["fig_5"], "force_reference", "filters", "sensitivity_peak", omega)
    assert not found.closed.all()
    assert np.isinf(found.bound[~found.closed]).any()
    assert np.isfinite(found.bound[0])


def test_an_envelope_cannot_be_changed(published):
    omega = np.array([10.0, 20.0])
    found = envelope(published["fig_5"], "velocity", "none", "equation_17", omega)
    with pytest.raises(ValueError, match="read-only"):
        found.bound[0] = 0.0
