"""The state estimator among what the tuner may turn."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.errors import InputError
from mptune.loops.position import position_controller
from mptune.loops.velocity import plant_at, true_velocity
from mptune.params.load import load_study
from mptune.params.pack import pack_measured
from mptune.robust.model import LinearModel
from mptune.robust.running import family_figures
from mptune.robust.tracking import family_tracking, verification_plants
from mptune.signals.estimator import heard
from mptune.sim.sampled import linear_moves
from mptune.tune.excesses import Excesses
from mptune.tune.space import Choice, space_of
from mptune.tune.tuner import Tuner

pytestmark = pytest.mark.compiled

FEW = ("uncertainty.points=2", "verification.repeats=1")


@pytest.fixture(scope="module")
def load_estimator(root):
    def load(*options, name="boom-estimator"):
        return load_study(root / "studies" / name / "study.toml", [*FEW, *options])

    return load


@pytest.fixture(scope="module")
def study(load_estimator):
    return load_estimator()


def test_the_estimators_numbers_are_free_and_put_over_the_model(study):
    model = LinearModel.of(study)
    space = space_of(model, 3e6)
    assert {"estimator_bandwidth", "estimator_mass", "preview"} <= set(space.names)
    own = Choice.of(model)
    found = space.choice(space.point(own))
    assert found.estimator.bandwidth == pytest.approx(own.estimator.bandwidth)
    assert found.estimator.mass == pytest.approx(own.estimator.mass)
    assert found.feedforward.preview == pytest.approx(own.feedforward.preview)
    other = own._replace(estimator=own.estimator.model_copy(update={"bandwidth": 80.0}))
    assert own.put_over(model).filters == model.filters
    moved = other.put_over(model)
    assert moved.filters.filter_time == 1 / 80.0
    assert moved.filters == pack_measured(moved.study)
    assert moved.gains == model.gains


def test_an_estimator_cannot_be_free_where_there_is_none(load_boom):
    options = ('objective.tracking_loop="sampled"', 'objective.free=["estimator_mass"]')
    with pytest.raises(InputError, match="no state estimator"):
        load_boom(*options, corners=True)


def test_tracking_on_the_machines_of_verification_is_their_linear_check(load_estimator):
    """Two programs of the same moves, but for moves that follow one another."""
    none = ('feedforward.viscous_friction="0 N s/m"', 'feedforward.coulomb_friction="0 N"')
    study = load_estimator(*none)
    model = LinearModel.of(study)
    peaks = family_tracking(model, model.gains, study.study.feedforward).max(axis=(1, 2))
    plants = verification_plants(study)
    assert set(plants.mass) == {24_500.0, 36_000.0, 49_000.0}
    assert plants.number == 9
    moves = [one.performance_index_ms for one in linear_moves(study)]
    np.testing.assert_allclose(1e3 * peaks, moves, rtol=0.1)


def test_the_search_keeps_what_is_asked_and_turns_the_estimator(load_estimator):
    start = ('estimator.bandwidth="52 rad/s"', 'gains.k_i_pos="17 1/s^2"')
    tuner = Tuner(load_estimator(*start, "requirements.gain_margin=1.6"))
    _, found = tuner.searched(first=tuner.before)
    assert found.feasible
    assert found.choice.estimator.bandwidth != pytest.approx(52.0, rel=1e-3)
    model = found.choice.put_over(LinearModel.of(load_estimator()))
    figures = family_figures(model.as_it_runs(found.choice.gains), model.period, 0.05)
    assert figures.gain_margin.min() >= 1.6
    assert figures.sensitivity_peak.max() <= 4.5
    assert figures.peak_compliance.max() <= 3.17e-7


def test_excesses_follow_the_path_that_is_asked(study):
    model = LinearModel.of(study)
    required = Excesses(model, model.gains)
    assert "position_ratio" not in required.names  # printed for information only
    own = Choice.of(model)
    fast = own._replace(estimator=own.estimator.model_copy(update={"bandwidth": 150.0}))
    there = fast.put_over(model)
    apart = required.of(model.gains, there.filters)
    np.testing.assert_allclose(apart, Excesses(there, model.gains).of(model.gains), atol=1e-9)
    assert np.abs(apart - required.of(model.gains)).max() > 1e-2
    np.testing.assert_array_equal(required.of(model.gains, model.filters), required.of(model.gains))


def test_a_load_is_heard_as_force(study):
    """Position over load from the machine's own balance, m s² x = F − F_load, F = P F_ref."""
    model = LinearModel.of(study)
    loops = model.as_it_runs(model.gains)
    figures = family_figures(loops, model.period, 0.05)
    for n in range(0, loops.plants.number, 3):
        s, plant = 1j * figures.compliance_frequency[n], plant_at(loops.plants, n)
        known, law = heard(s, loops.path), position_controller(s, *model.gains[1:])
        force = model.gains.k_p_vel * plant.mass * s * true_velocity(s, plant)  # K_P,vel P
        of_force = force * (known.speed_of_force + law * known.place_of_force)
        of_place = force * (known.speed_of_place + law * known.place_of_place)
        balance = plant.mass * s**2 + of_place / (1 + of_force)
        assert figures.peak_compliance[n] == pytest.approx(1 / abs(balance), rel=0.02)
        deaf = 1 / abs(plant.mass * s**2 * (1 + of_force) + of_place)  # |S|/(mω²)
        assert deaf < 0.8 * figures.peak_compliance[n]
