"""The frequencies of a sweep."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.robust.grid import first_grid, frequency_range, refinement
from mptune.robust.model import LinearModel


@pytest.fixture
def limits(load_boom):
    model = LinearModel.of(load_boom(corners=True))
    return model, frequency_range(model.plants, model.nominal, model.gains)


def test_the_grid_spans_every_corner_of_loop_and_controller(limits):
    model, (low, high) = limits
    gains = model.gains
    corners = [gains.k_p_vel / 49000, gains.omega, 1 / gains.tau, gains.k_p_pos]
    corners.append(gains.k_i_pos / gains.k_p_pos)
    assert low < min(corners) / 10
    assert high > max(corners) * 5


def test_above_the_grid_every_ratio_is_small(limits):
    model, (_, high) = limits
    found = model.sides(high * np.geomspace(1, 1000, 100), model.gains)
    assert np.all(found.ratio <= 0.05)


def test_the_range_is_found_without_integral_or_proportional_term(limits):
    model, _ = limits
    for changes in ({"k_i_pos": 0.0}, {"k_p_pos": 0.0}, {"k_i_pos": 0.0, "k_p_pos": 0.0}):
        low, high = frequency_range(model.plants, model.nominal, model.gains._replace(**changes))
        assert 0 < low < high < np.inf


def test_new_frequencies_stand_beside_the_highest_peak_only():
    omega = np.arange(1.0, 10.0)
    values = np.array([0, 1, 0, 0, 0, 5, 0, 0, 0.0])
    new = refinement(omega, values)
    assert new.tolist() == [5.25, 5.5, 5.75, 6.25, 6.5, 6.75]


def test_a_second_peak_that_is_nearly_as_high_is_refined_too():
    omega = np.arange(1.0, 10.0)
    values = np.array([0, 4.9, 0, 0, 0, 5, 0, 0, 0.0])
    new = refinement(omega, values)
    assert np.any((new > 1) & (new < 3))
    assert np.any((new > 5) & (new < 7))


def test_a_level_curve_is_not_refined_everywhere():
    omega = np.geomspace(0.1, 1000, 400)
    assert len(refinement(omega, np.zeros(400))) <= 6
    level = np.where(np.abs(np.arange(400) - 200) < 50, 1.0, 0.5)
    assert len(refinement(omega, level)) <= 6


def test_a_peak_between_two_equal_values_is_refined():
    omega = np.arange(1.0, 10.0)
    new = refinement(omega, np.array([0, 1, 2, 5, 5, 2, 1, 0, 0.0]))
    assert np.any((new > 4) & (new < 5))


@pytest.mark.parametrize("end", [0, 8])
def test_a_peak_at_an_end_of_the_grid_is_refined_inwards(end):
    omega = np.arange(1.0, 10.0)
    values = np.exp(-np.abs(np.arange(9.0) - end))
    new = refinement(omega, values)
    assert len(new) == 3
    assert np.all(np.abs(new - omega[end]) < 1)


def test_the_first_grid_rises_from_end_to_end():
    grid = first_grid(0.1, 1000.0)
    assert grid[0] == pytest.approx(0.1)
    assert grid[-1] == pytest.approx(1000)
    assert np.all(np.diff(grid) > 0)
