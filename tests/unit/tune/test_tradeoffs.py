"""Simpler controllers under the same requirements, and tracking against disturbance."""

from itertools import pairwise

import numpy as np
import pytest

from mptune.tune.baselines import baselines
from mptune.tune.front import front
from mptune.tune.tuner import tune

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes


@pytest.fixture(scope="module")
def rows(load_boom, tuned_boom):
    return {row.name: row for row in baselines(load_boom(corners=True), tuned_boom)}


def test_each_controller_meets_the_same_requirements(rows):
    assert list(rows) == ["own", "p", "pi", "pid", "eq22"]
    for name, row in rows.items():
        print(
            f"{name}: {1e3 * row.figures.tracking:.2f} ms, K_I,pos {row.gains.k_i_pos:.1f}, Eq. 21 "
            f"{row.sweep.position.worst_ratio:.3f}"
        )
        assert row.sweep.satisfied, name
        assert {check.limit for check in row.sweep.checks} == {
            check.limit for check in rows["own"].sweep.checks
        }


def test_each_controller_is_no_worse_than_those_it_holds(rows):
    """P is near PI as the study asks only K_I ≥ 22 of it; PI is PID without K_D; PID is Eq. 22."""
    index = [rows[name].figures.tracking for name in ("p", "pi", "pid", "eq22")]
    for simpler, richer in pairwise(index):
        assert richer <= 1.002 * simpler
    assert index[3] < 0.9 * index[2]  # Eq. 22's complex zeros are worth having


def test_structures_are_what_they_are_called(rows):
    for name in ("p", "pi"):
        gains = rows[name].gains
        assert (gains.xi, gains.omega * gains.tau) == (1.0, pytest.approx(1.0))
    assert rows["p"].gains.k_i_pos == 0
    assert rows["pid"].gains.xi >= 1  # its zeros are real
    assert rows["eq22"].gains.xi < 1


def test_baselines_of_what_cannot_be_met_say_so(load_boom):
    study = load_boom("requirements.velocity_ratio=0.45", corners=True)
    for row in baselines(study, tune(study)):
        assert not row.sweep.satisfied
        assert row.status is None or row.status.value == "infeasible"


@pytest.fixture(scope="module")
def drawn(load_boom):
    return front(load_boom(corners=True), 4)


def test_the_front_trades_tracking_for_integral_gain(drawn, tuned_boom):
    gains = [point.figures.integral_gain for point in drawn.points]
    index = [point.figures.tracking for point in drawn.points]
    for point in drawn.points:
        print(f"K_I,pos {point.gains.k_i_pos:.1f} 1/s²: {1e3 * point.figures.tracking:.3f} ms")
    assert len(gains) == 4
    assert gains == sorted(gains)
    assert index == sorted(index)
    assert index[0] == pytest.approx(tuned_boom.figures.tracking, rel=1e-3)
    assert np.all(np.diff(gains) > 1)


def test_every_point_of_the_front_keeps_the_requirements(drawn, load_boom):
    from mptune.robust.sweep import sweep

    study = load_boom(corners=True)
    for point in drawn.points:
        assert sweep(study, point.gains).satisfied


def test_a_front_where_nothing_is_feasible_is_empty(load_boom):
    found = front(load_boom("requirements.velocity_ratio=0.45", corners=True), 3)
    assert found.points == ()
    assert found.own.integral_gain == 22
