"""Results handed over: to matplotlib, xarray and pandas."""

from dataclasses import replace

import numpy as np
import pytest

import mptune
from mptune.interop import Drawn, Labelled, _standing_at
from mptune.sim.sampled import linear_moves

DRAWN = ("sweep", "tuned", "baseline", "front", "verified", "campaign", "panel", "identified")
DRAWN += ("weights", "job")


def results_that(kind):
    return [one for one in vars(mptune)["__all__"] if _is_a(getattr(mptune, one), kind)]


def _is_a(one, kind):
    return isinstance(one, type) and issubclass(one, kind)


@pytest.mark.parametrize("name", results_that(Drawn))
def test_every_drawing_is_there(name):
    drawings = getattr(mptune, name).drawings
    assert drawings
    for place in drawings.values():
        assert place.startswith("mptune.figures.")
        assert callable(_standing_at(place))


@pytest.mark.parametrize("name", results_that(Labelled))
def test_every_data_set_is_there(name):
    assert callable(_standing_at(getattr(mptune, name).dataset))


@pytest.mark.compiled
@pytest.mark.parametrize("name", DRAWN)
def test_a_result_draws_itself(results, name):
    from matplotlib.figure import Figure

    figure = results[name].plot()
    assert isinstance(figure, Figure)
    assert figure.axes


@pytest.mark.compiled
@pytest.mark.parametrize("drawing", ["bode", "nyquist", "sensitivity", "load"])
def test_a_sweep_has_drawings_by_name(unstable, drawing):
    assert unstable.plot(drawing).axes


def test_an_unknown_drawing_is_refused_with_those_that_are_there(fig_5):
    with pytest.raises(mptune.InputError, match=r"'pie' is none; one of panels, bode, nyquist"):
        fig_5.plot("pie")


def test_a_sweep_as_data_set_holds_what_it_found(fig_5):
    dataset = fig_5.to_xarray()
    np.testing.assert_array_equal(dataset["left"].sel(condition="velocity"), fig_5.velocity.left)
    assert dataset["frequency"].attrs["units"] == "rad/s"
    assert dataset.sizes["plant"] == fig_5.plants.number


def test_a_campaign_as_table_has_a_row_per_run(results):
    campaign = results["campaign"]
    table = campaign.to_pandas()
    assert len(table) == campaign.plan.runs
    np.testing.assert_array_equal(table["mass"], campaign.plan.points[:, 0])
    np.testing.assert_array_equal(table["final_error_mm"], campaign.column("final_error_mm"))
    assert list(table["reason"][[16, 17]]) == ["", "not finite"]


def test_an_identification_as_table_has_a_row_per_point_and_frequency(results):
    found = results["identified"]
    table = found.to_pandas()
    assert len(table) == len(found.panels) * found.panels[0].response.size
    value = table.xs(0, level="panel").xs(5, level="point")
    np.testing.assert_allclose(value["response_real"], found.panels[0].response[5].real)


def test_verified_machines_as_table(results):
    table = results["verified"].to_pandas()
    assert len(table) == len(results["verified"].cases)
    assert table["status"].iloc[-1] == "not finite"
    assert len(results["case"].to_pandas()) == 20
    assert results["case"].to_pandas()["valve_switches"].eq(840).all()
    assert results["verified"].to_xarray().sizes["case"] == 41


def test_a_move_as_table_is_its_traces_and_moves_are_rows(load_boom):
    moves = linear_moves(load_boom(corners=True))
    table = moves[0].to_pandas()
    np.testing.assert_array_equal(table.index, moves[0].time)
    np.testing.assert_array_equal(table["position_m"], moves[0].position)
    rows = mptune.to_pandas(moves)
    assert list(rows["mass_kg"]) == [one.mass_kg for one in moves]


def test_nested_keys_of_a_result_become_columns(results):
    table = mptune.to_pandas([results["baseline"]] * 2)
    assert len(table) == 2
    assert table["gains.k_p_vel"][0] == results["baseline"].gains.k_p_vel
    assert table["figures.tracking_index_s"].isna().all()
    assert len(results["front"].to_pandas()) == 40
    links = mptune.to_pandas(results["job"].chain)
    assert {"model", "gain_factor"} <= set(links)


def test_trials_as_table(results):
    table = results["weights"].to_pandas()
    assert len(table) == 80
    assert table["front"].sum() == 2
    assert not table["usable"].any()
    assert table["weights.weight_loss_n_per_j"].eq(80.0).all()


def test_a_response_as_table(results):
    table = results["response"].to_pandas()
    np.testing.assert_array_equal(table.index, results["response"].omega)
    np.testing.assert_allclose(table["magnitude_db"], results["response"].decibels)


def test_a_mass_that_is_learnt_is_drawn_even_where_it_stands_at_its_bound(results):
    plain = results["verified"]
    learns = plain.feedforward.model_copy(update={"adaptive_mass": True})
    drawn, bare = replace(plain, feedforward=learns).plot(), plain.plot()
    assert len(drawn.axes) == len(bare.axes) + 1
    assert drawn.axes[-1].get_ylabel() == "Learnt\nmass [t]"
    assert drawn.axes[-1].get_xlabel() == bare.axes[-1].get_xlabel() == "Time [s]"
