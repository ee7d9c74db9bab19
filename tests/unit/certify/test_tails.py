"""Beyond the cut no plant exceeds what is said of the tail."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.certify.climb import figure_at
from mptune.certify.enclosure import SIDES
from mptune.certify.form import curve_of, form_of
from mptune.certify.problem import edges_of
from mptune.certify.tails import tail_bound, tail_start

pytestmark = pytest.mark.compiled

LEVELS = {"equation_17": 0.4, "equation_21": 0.3, "sensitivity_peak": 1.2}
LEVELS |= {"complementary_peak": 0.5, "disk_margin": 0.7}
NAMES = [
    ("velocity", "equation_17"),
    ("position", "equation_21"),
    *((loop, figure) for loop in ("velocity", "position", "force_reference")
      for figure in ("sensitivity_peak", "complementary_peak", "disk_margin")),
]  # fmt: skip


@pytest.mark.parametrize("path", ["none", "filters"])
@pytest.mark.parametrize(("loop", "figure"), NAMES)
@pytest.mark.parametrize("gains", [{}, {"tau": 0.02}, {"k_i_pos": 0.0}, {"xi": 3.0, "omega": 15.0}])
def test_the_tail_is_below_its_bound(varied, loop, path, figure, gains):
    problem = varied(gains=gains, delay=(0.0, 0.03), tau_a=(0.0, 0.01), tau_b=(0.0, 0.01))
    form = form_of(problem, loop, path, figure)
    edges = edges_of(problem, (0.0, 0.0))
    start = tail_start(form, edges[1, 1], LEVELS[figure])
    assert tail_bound(form, edges[1, 1], start) <= LEVELS[figure]
    assert tail_bound(form, edges[1, 1], 0.99 * start) > LEVELS[figure]
    rng = np.random.default_rng(8)
    for _ in range(300):
        point = edges[0] + (edges[1] - edges[0]) * rng.uniform(-0.5, 1.5, SIDES).clip(0, 1)
        point[0] = start * 10 ** rng.choice([0.0, rng.uniform(0, 2)])
        value = figure_at(form, curve_of(1.0), point)
        assert value <= tail_bound(form, edges[1, 1], point[0]) <= LEVELS[figure]
