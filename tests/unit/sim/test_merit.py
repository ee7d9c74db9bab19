"""The table of §7's figures: every figure is in it once, and its units are what they say."""

from dataclasses import fields

import numpy as np
import pytest

from mptune.params.campaign import CampaignLimits
from mptune.sim.judge import SetFigures
from mptune.sim.merit import MERITS, TABULATED, Better, Over, merit
from mptune.units import registry

INTERNAL = {"oscillation", "saturated_s"}  # decide the status and are no merits


def test_every_figure_of_a_set_is_in_the_table_in_the_same_order():
    keys = [field.name for field in fields(SetFigures) if field.name not in INTERNAL]
    assert [one.key for one in MERITS] == keys
    assert len({one.name for one in MERITS}) == len(MERITS)


@pytest.mark.parametrize("one", MERITS, ids=lambda one: one.key)
def test_the_factor_is_the_unit_in_si_and_the_key_ends_with_the_unit(one):
    quantity = registry().Quantity(1.0, one.unit).to_base_units()
    assert one.factor == pytest.approx(float(quantity.magnitude), rel=1e-12)
    if one.unit != "1":
        ending = one.unit.lower().replace("/", "_per_").replace("^2 ", "2").replace(" ", "_")
        ending = ending.removeprefix("1_")  # "per_s", not "1_per_s"
        assert one.key in {f"{one.name}_{ending}", f"{one.name}_{ending.replace('_per_', '_')}"}


def test_every_limit_of_a_campaign_is_a_figure_s():
    assert set(CampaignLimits.model_fields) <= {one.name for one in MERITS}
    for one in MERITS:
        if one.name in CampaignLimits.model_fields:
            units = {name: unit for name, unit, *_ in CampaignLimits.quantities()}
            assert registry().Quantity(1.0, one.unit).check(units[one.name])


@pytest.mark.parametrize(
    ("key", "counts"),
    [("performance_index_ms", 2.0), ("final_error_mm", 3.0), ("pressure_min_mpa", 1.0)],
)
def test_sets_count_by_their_mean_or_their_worst(key, counts):
    assert merit(key).of_sets([1.0, 2.0, 3.0]) == counts
    assert np.isnan(merit(key).of_sets([]))


def test_only_the_least_pressure_is_the_better_the_higher_it_is():
    assert [one.key for one in MERITS if one.better is Better.HIGHER] == ["pressure_min_mpa"]
    assert merit("pressure_min_mpa").badness(1.0) > merit("pressure_min_mpa").badness(2.0)
    assert list(merit("final_error_mm").badness(np.array([1.0, 2.0]))) == [1.0, 2.0]
    assert {one.over for one in TABULATED} == {Over.MEAN, Over.LARGEST}


def test_names_in_print():
    force = merit("force_error_integral_kn2s")
    assert force.axis == "Force error ∫ΔF² [kN² s]"
    assert force.heading() == force.title() == "∫ΔF² [kN² s]"
    assert merit("performance_index_ms").title("\n") == "Index\n[ms]"
    assert merit("valve_switches").heading() == "switches"
    assert merit("valve_switches").axis == "Valve switches per set [–]"
    assert merit("valve_switches").text(803.04) == "803"
    assert merit("final_error_mm").text(0.2039) == "0.2"


def test_an_unknown_figure_is_a_key_error():
    with pytest.raises(KeyError):
        merit("elegance")
