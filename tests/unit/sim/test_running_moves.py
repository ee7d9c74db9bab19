"""Moves and steps of a whole family as it runs, against single runs of the same linear machine."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.loops.velocity import plant_at
from mptune.params.pack import pack_feedforward
from mptune.robust.model import LinearModel
from mptune.sim.judge import performance_index
from mptune.sim.moves import distinct_moves
from mptune.sim.running import BAND, step_figures, tracking_peaks
from mptune.sim.sampled import run_linear


@pytest.fixture(scope="module")
def model(load_boom):
    return LinearModel.of(load_boom(uncertainty="section-5-1", corners=True))


@pytest.mark.parametrize("mass", [0.0, 30e3])
def test_the_largest_of_the_peaks_is_the_index(model, mass):
    ahead = pack_feedforward(
        model.study.study.feedforward.model_copy(update={"acceleration_mass": mass}), 0.0005
    )
    loops, move = model.as_it_runs(model.gains), distinct_moves(model.study.study.manoeuvre)[0]
    peaks = tracking_peaks(loops, model.period, move, ahead, 16)
    assert peaks.shape == (16, 16)
    ticks = round(move.duration / 0.0005) // 16 * 16
    for n in (0, 9, 15):
        wanted, position, velocity, _ = run_linear(
            plant_at(loops.plants, n), model.gains, model.filters, model.period, move.pieces,
            ahead, ticks,
        )  # fmt: skip
        index = performance_index(wanted - position, velocity)
        assert peaks[n].max() == pytest.approx(index, rel=1e-12)


@pytest.mark.compiled  # long without it
def test_a_loop_that_runs_away_has_no_finite_index_but_a_search_is_told_the_way_back(model):
    gains = model.gains._replace(k_p_vel=5 * model.gains.k_p_vel)
    ahead = pack_feedforward(model.study.study.feedforward, 0.0005)
    loops, move = model.as_it_runs(gains), distinct_moves(model.study.study.manoeuvre)[0]
    found = tracking_peaks(loops, model.period, move, ahead, 16).max(axis=1)
    assert np.isinf(found).any()
    searched = tracking_peaks(loops, model.period, move, ahead, 16, running_away=True).max(axis=1)
    assert np.isfinite(searched).all()
    stays = np.isfinite(found)
    assert np.array_equal(found[stays], searched[stays])
    calm = model.as_it_runs(model.gains)
    assert np.isfinite(tracking_peaks(calm, model.period, move, ahead, 16)).all()


@pytest.mark.compiled  # long without it
def test_overshoot_and_settling_are_those_of_the_step(model):
    loops = model.as_it_runs(model.gains)
    found = step_figures(loops, model.period, 0.8)
    none = pack_feedforward(model.study.study.feedforward, 0.0005)
    step = np.array([[0.0, 1, 0, 0, 0, 0, 0]])
    for n in (0, 15):
        position = run_linear(
            plant_at(loops.plants, n), model.gains, model.filters, model.period, step, none, 8000
        )[1]
        assert found.overshoot[n] == pytest.approx(position.max() - 1, rel=1e-12)
        outside = np.flatnonzero(np.abs(position - 1) > BAND)
        assert found.settling_time[n] == pytest.approx(0.0005 * (outside[-1] + 1))
        late = np.abs(position[1600:] - 1).max() / BAND
        assert found.late_deviation[n] == pytest.approx(late, rel=1e-6)


@pytest.mark.compiled  # long without it
def test_what_never_settles_has_no_settling_time(model):
    gains = model.gains._replace(k_p_vel=3 * model.gains.k_p_vel)
    found = step_figures(model.as_it_runs(gains), model.period)
    assert np.isinf(found.settling_time).any()
