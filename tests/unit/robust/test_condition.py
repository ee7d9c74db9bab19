"""Both sides of Eq. 17 and Eq. 21 over a family."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.loops.family import FamilyLoops
from mptune.params.pack import NO_PATH, LoopGains, NominalPlant, Plants
from mptune.robust.condition import sides

GAINS = LoopGains(700e3, 13.0, 22.0, 42.0, 0.55, 0.006)
NOMINAL = NominalPlant(24500.0, 0.011)
OMEGA = np.geomspace(0.5, 500, 40)


@pytest.fixture
def family():
    random = np.random.default_rng(7)
    spans = ((20e3, 60e3), (0.005, 0.025), (0.0, 0.012), (0.0, 0.012), (0.5, 0.6))
    return Plants(*(random.uniform(low, high, 12) for low, high in spans))


def evaluate(plants, omega=OMEGA):
    return sides(omega, FamilyLoops(plants, GAINS, NO_PATH), NOMINAL)


def test_the_order_of_plants_changes_nothing(family):
    order = np.random.default_rng(1).permutation(12)
    shuffled = evaluate(family.picked(order))
    found = evaluate(family)
    np.testing.assert_array_equal(shuffled.left, found.left)
    np.testing.assert_array_equal(shuffled.right, found.right)
    np.testing.assert_array_equal(order[shuffled.plant], found.plant)
    np.testing.assert_array_equal(shuffled.plant_ratio, found.plant_ratio[:, order])


@pytest.mark.parametrize("count", [1, 2, 15, 16, 17, 40])
def test_how_many_frequencies_stand_together_changes_nothing(family, count):
    found, part = evaluate(family), evaluate(family, OMEGA[:count])
    np.testing.assert_array_equal(part.left, found.left[:, :count])
    np.testing.assert_array_equal(part.plant, found.plant[:, :count])


def test_the_envelope_is_the_largest_of_each_plant_alone(family):
    alone = [evaluate(family.picked(np.array([n]))) for n in range(12)]
    found = evaluate(family)
    np.testing.assert_array_equal(found.left, np.max([one.left for one in alone], axis=0))
    np.testing.assert_array_equal(found.plant, np.argmax([one.left for one in alone], axis=0))


def test_each_plant_s_worst_ratio_and_its_frequency_belong_together(family):
    found = evaluate(family)
    for n in range(12):
        alone = evaluate(family.picked(np.array([n])))
        for loop in range(2):
            assert found.plant_ratio[loop, n] == pytest.approx(alone.ratio[loop].max(), rel=1e-13)
            at = found.plant_frequency[loop, n]
            assert alone.ratio[loop, at] == pytest.approx(found.plant_ratio[loop, n], rel=1e-13)


def test_another_plant_can_only_raise_the_left_side(family):
    fewer = evaluate(family.picked(np.arange(6)))
    assert np.all(evaluate(family).left >= fewer.left)


def test_the_nominal_plant_alone_leaves_nothing_on_the_left():
    plants = Plants(*(np.array([value]) for value in (24500.0, 0.011, 0.0, 0.0, 0.57)))
    found = evaluate(plants)
    assert np.all(found.left == 0)
    assert np.all(found.plant_ratio == 0)
