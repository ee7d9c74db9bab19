"""What is concluded from runs whose figures are known."""

import numpy as np
import pytest
from scipy.stats import spearmanr

from mptune.campaign.plan import plan_campaign
from mptune.campaign.result import QUANTILES, CampaignResult
from mptune.campaign.simulate import FIGURES
from mptune.cli.show_campaign import campaign


@pytest.fixture
def made(plan):
    """Runs whose index is the mass in tonnes, whose error is random; two failed, one blew up."""

    def result(*overrides):
        one = plan("runs=100", *overrides)
        figures = np.full((100, len(FIGURES)), 1.0)
        figures[:, 0] = one.points[:, 0] / 1e3
        figures[:, FIGURES.index("final_error_mm")] = np.random.default_rng(5).random(100)
        figures[:, FIGURES.index("pressure_min_mpa")] = -np.arange(100.0)
        figures[17] = np.nan
        status, reason = np.full(100, "stable", "U32"), np.full(100, "", "U64")
        status[17], reason[17] = "not finite", "not finite"
        reason[4] = "final_error 2 mm is above 1 mm"
        return CampaignResult(one, figures, status, reason)

    return result


def test_quantiles_and_worst_run_leave_out_runs_without_the_figure(made):
    result = made()
    index = np.delete(result.plan.points[:, 0], 17) / 1e3
    assert result.quantiles("performance_index_ms")[-1] == index.max()
    assert result.quantiles("performance_index_ms")[QUANTILES.index(0.5)] == np.median(index)
    worst = result.worst_run("performance_index_ms")
    assert result.column("performance_index_ms")[worst] == index.max()


def test_the_least_pressure_is_the_worst(made):
    assert made().worst_run("pressure_min_mpa") == 99


def test_rank_correlation_is_spearmans(made):
    result, keep = made(), np.arange(100) != 17
    found = result.correlations("final_error_mm")
    for place, name in zip(result.plan.box.varying, result.plan.box.names, strict=True):
        values = result.column("final_error_mm")[keep]
        wanted = spearmanr(result.plan.points[keep, place], values).statistic
        assert found[name] == pytest.approx(wanted, abs=1e-12)
    assert result.correlations("performance_index_ms")["mass"] == pytest.approx(1.0)
    assert np.isnan(result.correlations("energy_loss_j_per_mm")["mass"])  # the same in all


def test_failures_are_counted_by_their_reason(made):
    result = made()
    assert result.failures == 2
    assert result.reasons() == {"final_error above its limit": 1, "not finite": 1}
    assert not result.satisfied


def test_a_wanted_failure_probability_decides_the_verdict(made):
    assert made("failure_probability=0.2", "doubt=0.01").satisfied
    assert not made("failure_probability=0.05", "doubt=0.01").satisfied


@pytest.mark.parametrize("method", ["sobol", "monte carlo"])
def test_only_independent_draws_guarantee_anything(made, method):
    found = made(f"method={method}").guarantee
    assert (found is None) == (method == "sobol")


def test_json_says_where_the_worst_is_and_can_be_written(made):
    import json

    values = made().json()
    json.dumps(values)
    worst = values["figures"]["performance_index_ms"]
    assert worst["worst"] == pytest.approx(worst["worst_at"]["mass_kg"] / 1e3)
    assert values["parameters"]["mass_kg"] == [24500, 49000]
    assert values["first_failures"] == [4, 17]


def test_of_converters_is_shown_where_there_are_some(load_shape, capsys):
    """A panel, a column of correlations and a row of the table; none that holds nothing."""
    for name, some in (("four-chamber", False), ("four-converters", True)):
        one = plan_campaign(load_shape(name, "campaign.runs=20"))
        figures = np.random.default_rng(3).random((20, len(FIGURES)))
        if not some:
            figures[:, FIGURES.index("converter_peak_mm")] = np.nan
        told = np.full(20, "stable", "U32"), np.full(20, "", "U64")
        result = CampaignResult(one, figures, *told)
        drawn = result.plot().axes
        panels = [axes for axes in drawn[:6] if axes.axison]
        assert ["Converter" in axes.get_xlabel() for axes in panels].count(True) == some
        assert all(axes.lines for axes in panels)
        columns = [text.get_text() for text in drawn[6].get_xticklabels()]
        assert ("converter" in columns) == some
        assert len(columns) == len(panels)
        campaign(result)
        assert ("converter_peak_mm" in capsys.readouterr().out) == some
