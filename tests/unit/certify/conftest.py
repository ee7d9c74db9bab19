"""The paper's own problem over both of its boxes, and one to vary."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mptune.certify.problem import BoxedLoop


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
