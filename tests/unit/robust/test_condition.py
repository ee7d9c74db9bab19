"""Both sides of Eq. 17 and Eq. 21 over a family."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.loops.family import FamilyLoops
from mptune.params.packed import NO_PATH, LoopGains, NominalPlant, Plants
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


def by_hand(plants):
    """Return |Δ| ``(2, N, F)`` and |(1 + L)/L| ``(2, F)`` from Eq. 14 to Eq. 22 as printed."""
    s, k = 1j * OMEGA, GAINS.k_p_vel
    mass, delay, tau_a, tau_b, share_a = (column[:, None] for column in plants)
    force = share_a / (tau_a * s + 1) + (1 - share_a) / (tau_b * s + 1)  # Eq. 11
    model = np.exp(-s * NOMINAL.delay) / (NOMINAL.mass * s)  # Eq. 14
    true = force * np.exp(-s * delay) / (mass * s)  # Eq. 15
    shape = s**2 / GAINS.omega**2 + 2 * GAINS.xi * s / GAINS.omega + 1
    controller = GAINS.k_p_pos * shape / (GAINS.tau * s + 1) ** 2 + GAINS.k_i_pos / s  # Eq. 22
    closed_model, closed = (g * k / (s * (1 + g * k)) for g in (model, true))  # Eq. 19
    loop = np.stack([model * k, closed_model * controller])
    left = np.abs(np.stack([(true - model) / model, (closed - closed_model) / closed_model]))
    return left, np.abs((1 + loop) / loop)


def test_both_sides_are_those_of_the_equations(family):
    found, (left, right) = evaluate(family), by_hand(family)
    np.testing.assert_allclose(found.left, left.max(axis=1), rtol=1e-9)
    np.testing.assert_allclose(found.right, right, rtol=1e-9)
    expected = (left / right[:, None, :]).max(axis=2)
    np.testing.assert_allclose(found.plant_ratio, expected, rtol=1e-9)
