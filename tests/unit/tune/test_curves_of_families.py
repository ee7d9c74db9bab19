"""Whole curves of a family: what a sweep keeps of them, and what a search takes for its loops."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.loops.broken import FORCE
from mptune.loops.position import position_controller
from mptune.loops.sampled import coefficient_count, sampled_loop, sampled_plant
from mptune.loops.velocity import plant_at
from mptune.robust.curves import error_curves, loop_curves
from mptune.robust.model import LinearModel
from mptune.tune.core import SAMPLED, TRUE, Core

OMEGA = np.geomspace(1.0, 200.0, 12)
ROWS = np.array([0, 7, 15])


@pytest.fixture(scope="module")
def model(load_boom):
    asked = ("requirements.sampled_sensitivity_peak=2", "requirements.sensitivity_peak=2")
    return LinearModel.of(load_boom(*asked, uncertainty="section-5-1", corners=True))


@pytest.fixture(scope="module")
def loops(model):
    limits = dict.fromkeys(("k_p_pos", "k_i_pos", "omega", "xi"), (0.1, 100.0))
    return Core(model, model.gains, ROWS, limits).problem(model.gains.tau, "tracking").loops


def test_the_sweep_s_envelopes_are_the_largest_of_the_curves(model):
    velocity = model.nominal_gains(OMEGA, model.gains)[0]
    curves = error_curves(OMEGA, model.plants, model.nominal, velocity)
    left = model.sides(OMEGA, model.gains).left
    np.testing.assert_allclose(left, curves.max(axis=1), rtol=1e-12)


def test_the_search_s_parts_add_up_to_the_loop(model, loops):
    plant, fixed = loops[TRUE].between(OMEGA, np.arange(len(ROWS)))
    outer = position_controller(1j * OMEGA, *model.gains[1:])
    wanted = loop_curves(FORCE, OMEGA, model.loops(model.gains))[ROWS]
    np.testing.assert_allclose(plant * outer + fixed, wanted, rtol=1e-10)


def test_the_search_s_sampled_parts_add_up_to_the_sampled_loop_at_tustin_s_frequencies(
    model, loops
):
    parts, fixed = loops[SAMPLED].between(OMEGA, np.arange(len(ROWS)))
    outer = position_controller(1j * OMEGA, *model.gains[1:])
    half = model.period / 2
    true = np.arctan(OMEGA * half) / half
    for n, row in enumerate(ROWS):
        plant = plant_at(model.explicit, row)
        count = coefficient_count(plant.delay, model.filters, model.period)
        one = sampled_plant(plant, model.filters, model.period, count)
        wanted = [sampled_loop(1j * at, one, model.gains, model.period) for at in true]
        np.testing.assert_allclose(parts[n] * outer + fixed[n], wanted, rtol=1e-9)
