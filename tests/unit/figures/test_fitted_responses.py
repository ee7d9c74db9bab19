"""Measured responses drawn with their fits."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.figures.measured import fitted_responses
from mptune.identify.fit import fit, model
from mptune.identify.response import FrequencyResponse

SHARE = 0.571
OMEGA = np.geomspace(2, 300, 40)


def made(name, delay):
    value = model(OMEGA, np.array([6e-3, 11e-3, delay]), SHARE)
    value[3] = np.nan
    return FrequencyResponse(OMEGA, value, np.full(40, 0.99), name)


def test_each_response_lies_on_its_fit_in_magnitude_and_phase():
    responses = [made("cold", 20e-3), made("warm", 12e-3)]
    figure = fitted_responses(responses, [fit(one, SHARE) for one in responses], SHARE)
    magnitude, phase, coherence = figure.axes
    for axes in (magnitude, phase):
        assert len(axes.lines) == 4
        for points, curve in (axes.lines[:2], axes.lines[2:]):
            assert len(points.get_xdata()) == 39
            np.testing.assert_allclose(points.get_ydata(), curve.get_ydata(), atol=1e-3)
    assert len(coherence.lines) == 2
    assert "dB" in magnitude.get_ylabel()
    assert "°" in phase.get_ylabel()
    assert "rad/s" in coherence.get_xlabel()


def test_a_phase_that_was_measured_turns_away_is_drawn_on_its_fit():
    one = made("late", 12e-3)
    late = FrequencyResponse(OMEGA[20:], one.response[20:], one.quality[20:], "late")
    figure = fitted_responses([late], [fit(one, SHARE)], SHARE)
    points, curve = figure.axes[1].lines
    assert points.get_ydata()[0] == pytest.approx(curve.get_ydata()[0], abs=1e-3)
