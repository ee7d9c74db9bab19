"""Figures of a sweep whose worst plant is a measured response: it has no loop to be drawn."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.figures.bode import bode_plots
from mptune.figures.nyquist import nyquist_plots
from mptune.figures.panels import four_panels
from mptune.figures.sensitivity import load_response, sensitivity_functions
from mptune.robust.encirclements import encirclements
from mptune.robust.sweep import sweep

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

OMEGA = np.geomspace(0.5, 600, 300)
WORST = {"worst plant", "worst plant, with measurement path"}
FIGURES = {
    "panels": four_panels,
    "bode": bode_plots,
    "nyquist": lambda result: nyquist_plots(result, encirclements(result)),
    "sensitivity": sensitivity_functions,
    "load": load_response,
}


@pytest.fixture
def measured(load_measured):
    """A sweep in which both conditions are worst in a slow and late measured response."""
    force = np.exp(-0.026j * OMEGA) / (1 + 0.012j * OMEGA)
    found = sweep(load_measured(OMEGA, force))
    assert [condition.at.response for condition in found.conditions] == ["rig", "rig"]
    return found


def labels(figure):
    (legend,) = figure.legends
    return {text.get_text() for text in legend.get_texts()}


@pytest.mark.parametrize("name", ["bode", "nyquist"])
def test_a_measured_response_is_no_worst_plant_whose_loop_is_drawn(measured, load_boom, name):
    draw = FIGURES[name]
    without = labels(draw(measured))
    assert without.isdisjoint(WORST)
    assert labels(draw(sweep(load_boom(corners=True)))) == without | WORST


@pytest.mark.parametrize("name", FIGURES)
def test_no_line_is_empty(measured, name):
    for axes in FIGURES[name](measured).axes:
        assert axes.lines
        for line in axes.lines:
            assert np.isfinite(np.asarray(line.get_ydata(), float)).any(), line.get_label()
