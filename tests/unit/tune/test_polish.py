"""The polish on problems whose optimum is known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mptune.tune.polish import Values, polish

WIDE = np.full(2, -5.0), np.full(2, 5.0)
NONE = np.zeros(0)


class Counted:
    """A function that counts its calls and notes where it was asked."""

    def __init__(self, function):
        self.function, self.points = function, []

    def __call__(self, point):
        self.points.append(point.copy())
        return self.function(point)


def tents(point):
    """Three planes whose upper envelope is least, 1, at (1, 2)."""
    x, y = point[0] - 1, point[1] - 2
    return Values(1 + np.array([x + y, x - 2 * y, -2 * x + 0.5 * y]), 0.0, NONE)


def bowl(centre, *limits, smooth=True):
    """|p − c|² under linear limits (normal, room): excess = normal·p − room."""

    def evaluate(point):
        value = float(np.sum((point - centre) ** 2))
        over = np.array([normal @ point - room for normal, room in limits])
        return Values(NONE, value, over) if smooth else Values(np.array([value]), 0.0, over)

    return evaluate


@given(st.lists(st.floats(-4.5, 4.5), min_size=2, max_size=2))
def test_a_minimax_with_a_kink_is_found_from_anywhere(start):
    found = polish(tents, np.array(start), *WIDE)
    np.testing.assert_allclose(found.point, [1, 2], atol=2e-4)
    assert found.values.cost == pytest.approx(1, abs=1e-4)
    assert found.converged


@pytest.mark.parametrize("smooth", [True, False])
def test_active_bounds_above_and_below_hold_the_optimum(smooth):
    low, high = np.array([-1.0, 0.5]), np.array([0.25, 3.0])
    found = polish(bowl(np.array([2.0, -2.0]), smooth=smooth), np.array([0.0, 1.0]), low, high)
    np.testing.assert_allclose(found.point, [0.25, 0.5], atol=2e-5)
    assert found.converged


def test_a_start_in_the_upper_corner_is_no_trap():
    low, high = np.zeros(2), np.ones(2)
    found = polish(bowl(np.array([0.3, 0.6])), high.copy(), low, high)
    np.testing.assert_allclose(found.point, [0.3, 0.6], atol=2e-3)
    assert found.values.cost < 1e-5


@pytest.mark.parametrize("start", [[4.0, 4.0], [-4.0, 4.0], [0.0, 0.0]])
def test_requirements_are_reached_from_starts_that_break_them(start):
    """min |p|² with x + y ≥ 2: (1, 1)."""
    evaluate = bowl(np.zeros(2), (np.array([-1.0, -1.0]), -2.0))
    found = polish(evaluate, np.array(start), *WIDE)
    np.testing.assert_allclose(found.point, [1, 1], atol=1e-3)
    assert found.values.feasible
    assert found.values.excesses.max() <= 1e-6


def test_a_curved_requirement_with_a_minimax_objective():
    """max(x, y) least on the unit disk about (2, 2): 2 − 1/√2."""

    def evaluate(point):
        return Values(point.copy(), 0.0, np.log([np.sum((point - 2) ** 2)]))

    found = polish(evaluate, np.array([2.5, 2.1]), *WIDE)
    assert found.values.cost == pytest.approx(2 - 0.5**0.5, abs=1e-5)
    assert found.values.feasible


def test_peaks_and_a_smooth_part_are_added():
    """max(x, −x) + (x − 1)²: least at x = 1/2."""

    def evaluate(point):
        return Values(np.array([point[0], -point[0]]), float((point[0] - 1) ** 2), NONE)

    found = polish(evaluate, np.array([-3.0]), np.array([-5.0]), np.array([5.0]))
    assert found.point[0] == pytest.approx(0.5, abs=2e-3)
    assert found.values.cost == pytest.approx(0.75, abs=1e-5)


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1.0, 1e4])
def test_the_size_of_the_objective_does_not_matter(scale):
    def evaluate(point):
        values = tents(point)
        return Values(scale * values.peaks, 0.0, NONE)

    found = polish(evaluate, np.array([-3.0, 4.0]), *WIDE)
    np.testing.assert_allclose(found.point, [1, 2], atol=1e-3)
    assert found.values.cost == pytest.approx(scale, rel=1e-3)


def test_where_nothing_is_feasible_the_point_says_so():
    evaluate = bowl(np.zeros(2), (np.array([1.0, 0.0]), -1.0), (np.array([-1.0, 0.0]), -1.0))
    found = polish(evaluate, np.array([2.0, 2.0]), *WIDE)
    assert not found.values.feasible
    assert found.values.excesses.max() >= 1 - 1e-9  # x ≤ −1 and x ≥ 1


def test_relief_makes_one_requirement_as_small_as_the_others_allow():
    """x ≤ −1 gives; x ≥ 1 and x ≥ 3 stay: it would have to give by 4."""
    limits = [(np.array([1.0, 0.0]), -1.0), (np.array([-1.0, 0.0]), -1.0)]
    evaluate = bowl(np.zeros(2), *limits, (np.array([-1.0, 0.0]), -3.0))
    relieved = np.array([True, False, False])
    found = polish(evaluate, np.array([0.0, 0.0]), *WIDE, relieved)
    assert found.values.excesses[0] == pytest.approx(4, abs=1e-4)
    assert found.values.excesses[1:].max() <= 1e-6


def test_relief_of_all_is_the_nearest_point_to_all():
    """x ≤ −1 and x ≥ 1: at x = 0 both are off by 1."""
    evaluate = bowl(np.zeros(2), (np.array([1.0, 0.0]), -1.0), (np.array([-1.0, 0.0]), -1.0))
    found = polish(evaluate, np.array([3.0, 1.0]), *WIDE, np.ones(2, np.bool_))
    assert found.values.excesses.max() == pytest.approx(1, abs=1e-4)
    assert found.converged


def test_what_is_returned_is_the_best_that_was_seen_and_is_what_it_says():
    evaluate = Counted(bowl(np.zeros(2), (np.array([-1.0, -2.0]), -2.0)))
    found = polish(evaluate, np.array([4.0, -3.0]), *WIDE)
    again = evaluate.function(found.point)
    assert again.cost == pytest.approx(found.values.cost, rel=1e-12)
    np.testing.assert_allclose(again.excesses, found.values.excesses, atol=1e-15)
    kept = [evaluate.function(point) for point in evaluate.points]
    best = min(values.cost for values in kept if values.excesses.max() <= 1e-6)
    assert found.values.cost <= best + 1e-12
    assert found.evaluations >= len(evaluate.points) - 1


def test_an_end_that_is_worse_than_what_was_seen_is_not_called_converged(monkeypatch):
    """SLSQP may end happily at a point that breaks a requirement by more than its tolerance."""
    from types import SimpleNamespace

    from mptune.tune import polish as module

    def ends_elsewhere(objective, y, **_):
        objective(y)
        return SimpleNamespace(x=np.array([5.0, 5.0, 0.0]), success=True)

    monkeypatch.setattr(module, "minimize", ends_elsewhere)
    found = polish(bowl(np.zeros(2)), np.array([1.0, 1.0]), *WIDE)
    np.testing.assert_array_equal(found.point, [1, 1])
    assert not found.converged


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_values_that_are_not_finite_are_no_good_and_no_crash(bad):
    """A loop that runs away has no finite error: right of x = 2 here."""

    def evaluate(point):
        value = (point[0] - 1.5) ** 2
        return Values(np.array([bad if point[0] > 2 else value]), 0.0, np.array([-1.0]))

    for start in (-3.0, 4.0):
        found = polish(evaluate, np.array([start]), np.array([-5.0]), np.array([5.0]))
        assert np.isfinite(found.values.cost)
        assert found.point[0] <= 2 or start > 2


def test_nothing_free_is_an_answer():
    found = polish(lambda _: Values(np.array([3.0]), 0.5, np.array([-0.1])), NONE, NONE, NONE)
    assert (found.values.cost, found.converged, found.evaluations) == (3.5, True, 1)
