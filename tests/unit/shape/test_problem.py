"""A loop-shaping problem as data."""

import numpy as np
import pytest

from mptune.errors import InputError
from mptune.shape import structure
from mptune.shape.problem import (
    Function,
    Linear,
    Loops,
    Maximise,
    Peak,
    Problem,
    curve_at,
    sampled_curve,
)

OMEGA = np.geomspace(0.1, 10, 30)


def between(omega, rows):
    plant = np.array([(row + 1) / (1j * omega + 1) for row in rows])
    return plant, 0.1 * plant


LOOPS = Loops(OMEGA, *between(OMEGA, range(3)), between)
PEAK = Peak("M_S", Function.SENSITIVITY, 1.4, "nominal")


def problem(*requirements, loops=LOOPS, objective=None, **changes):
    objective = objective or Maximise(np.array([0.0, 1.0]))
    return Problem(
        structure.pi(), {"nominal": loops}, objective, requirements, lambda x: True, **changes
    )


def test_refined_loops_know_the_added_frequencies():
    added = np.array([0.5, 2.0])
    found = LOOPS.refined(added)
    assert np.all(np.diff(found.omega) > 0)
    assert set(added) <= set(found.omega)
    np.testing.assert_array_equal(found.plant, between(found.omega, range(3))[0])
    np.testing.assert_array_equal(found.fixed, between(found.omega, range(3))[1])


def test_picked_loops_keep_their_plants_between_grid_points():
    found = LOOPS.picked(np.array([2, 0])).refined(np.array([0.5]))
    np.testing.assert_array_equal(found.plant, between(found.omega, [2, 0])[0])


def test_sampled_loops_cannot_be_refined():
    sampled = Loops.of(OMEGA, 1 / (1j * OMEGA + 1))
    assert sampled.refined(np.array([0.5])) is sampled


def test_bounds_of_the_structure_are_requirements_that_can_be_left_out():
    whole = problem(PEAK, Linear("sum", np.ones(2), 3.0))
    assert whole.names == {"M_S", "sum", "k_p ≥", "k_i ≥"}
    assert whole.without("k_p ≥").names == {"M_S", "sum", "k_i ≥"}
    assert whole.without("sum").names == {"M_S", "k_p ≥", "k_i ≥"}


@pytest.mark.parametrize(
    ("requirements", "message"),
    [
        ([PEAK, PEAK], "names two requirements"),
        ([Linear("k_p ≥", np.ones(2), 1.0)], "names two requirements"),
        ([Linear("objective", np.ones(2), 1.0)], "names two requirements"),
        ([Peak("M_S", Function.SENSITIVITY, 1.4, "family")], "one of nominal"),
    ],
)
def test_ambiguous_names_and_missing_loops_are_refused(requirements, message):
    with pytest.raises(InputError, match=message):
        problem(*requirements)


def test_sampled_curve_goes_through_its_points_and_straight_between_in_logarithms():
    curve = sampled_curve(np.array([1.0, 100.0]), np.array([1.0, 0.01]))
    np.testing.assert_allclose(curve_at(curve, np.array([1.0, 10.0, 100.0])), [1, 0.1, 0.01])
    np.testing.assert_allclose(curve_at(curve, np.array([0.1, 1e3])), [1, 0.01])
    np.testing.assert_allclose(curve_at(1.4, OMEGA), 1.4)
