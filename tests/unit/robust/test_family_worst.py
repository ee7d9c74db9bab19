"""The worst value of each margin over a family: the largest of some, the least of others."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.loops.broken import FORCE
from mptune.params.packed import Plants
from mptune.robust.family import Family
from mptune.robust.margins import Margins

# What a plant may bear: of peaks and of the least gain that keeps a loop stable, the largest binds.
DIRECTION = {
    "sensitivity_peak": max,
    "complementary_peak": max,
    "gain_margin": min,
    "gain_reduction": max,
    "phase_margin": min,
    "delay_margin": min,
    "disk_margin": min,
    "peak_compliance": max,
}
FIGURES = {0: 1.3, 1: 1.7, 2: 1.1}  # by plant; the same numbers serve every margin


def family(**changes):
    """Return three plants whose margins are FIGURES, found at 10, 20 and 30 rad/s."""
    values = np.tile(list(FIGURES.values()), (3, 1))
    places = np.tile([10.0, 20.0, 30.0], (3, 1))
    margins = Margins(*(values, places) * (len(Margins._fields) // 2))._replace(**changes)
    masses, ones, every = np.array([1e4, 2e4, 3e4]), np.ones(3), np.ones(3, np.bool_)
    plants = Plants(masses, 0.01 * ones, 0 * ones, 0 * ones, 0.5 * ones)
    return Family("none", plants, every, every, every, margins)


def test_every_margin_has_a_direction():
    assert set(DIRECTION) == set(Margins._fields[::2])


@pytest.mark.parametrize("name", DIRECTION)
def test_the_worst_is_the_value_that_binds_and_its_plant_is_named(name):
    value, at = family().worst(name, FORCE)
    plant = DIRECTION[name](FIGURES, key=FIGURES.get)
    assert value == FIGURES[plant]
    assert at.mass_kg == 1e4 * (plant + 1)
    assert at.frequency_rad_s == 10.0 * (plant + 1)


def test_a_margin_without_limit_has_no_place():
    unlimited = np.full((3, 3), np.inf)
    found = family(gain_margin=unlimited, gain_frequency=np.full((3, 3), np.nan))
    assert found.worst("gain_margin", FORCE) == (np.inf, None)


def test_a_family_with_an_unstable_plant_has_no_worst_margin():
    values = np.array([[1.3, np.nan, 1.1]] * 3)
    worst, at = family(gain_reduction=values).worst("gain_reduction", FORCE)
    assert np.isnan(worst)
    assert at is None
