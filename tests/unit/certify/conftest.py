"""The paper's own problem over both of its boxes, and one to vary."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mptune.certify.problem import BoxedLoop
from mptune.params.estimator import place_estimator
from mptune.params.packed import MeasurementPath

FAST, BANDWIDTH, LEAST = 5e-4, 40.0, 24_500.0


@pytest.fixture(scope="session")
def published(load_boom):
    """The published gains over both boxes, whatever the path."""
    return {
        "fig_5": BoxedLoop.of(load_boom(twice=True)),
        "section_5_1": BoxedLoop.of(load_boom(uncertainty="section-5-1")),
    }


@pytest.fixture(scope="session")
def varied(published):
    """§5.1's problem with other gains, or another box."""

    def make(*, gains=None, **sides):
        problem = published["section_5_1"]
        box = replace(problem.box, **sides)
        return replace(problem, box=box, gains=problem.gains._replace(**(gains or {})))

    return make


@pytest.fixture(scope="session")
def hidden(varied):
    """A box that is stable at its corners, τ_B = 0 and 240 ms, and unstable between them."""
    return varied(
        mass=(24500.0, 24500.0),
        delay=(0.018, 0.018),
        tau_a=(0.0122, 0.0122),
        tau_b=(0.0, 0.24),
    )


@pytest.fixture(scope="session")
def estimated(varied):
    """§5.1's masses and delays under the published gains, around a state estimator."""
    by = place_estimator(BANDWIDTH, FAST)
    path = MeasurementPath(FAST, 0.0, 1 / BANDWIDTH, LEAST, *by)
    lags = {"tau_a": (0.005, 0.012), "tau_b": (0.005, 0.012)}
    problem = varied(mass=(24.5e3, 49e3), delay=(0.01, 0.014), **lags)
    return replace(problem, filters=path, explicit=None)
