"""Fitted ranges as an uncertainty section that a study takes."""

from __future__ import annotations

import tomllib
from dataclasses import replace

import numpy as np
import pytest
import tomlkit

from mptune.errors import InputError
from mptune.identify.fit import fit, model
from mptune.identify.fitted import Certainty, Fit, Interval
from mptune.identify.ranges import fitted_ranges, spread_in_words, uncertainty_section
from mptune.identify.response import FrequencyResponse
from mptune.identify.responses import write_response
from mptune.params.load import load_study
from mptune.robust.sweep import sweep

SHARE = 0.5714


def a_fit(name, tau_a, tau_b, delay, status=Certainty.DETERMINED):
    return Fit(
        name,
        *(Interval(*(1e-3 * end for end in one)) for one in (tau_a, tau_b, delay)),
        np.eye(3),
        50,
        0.01,
        "τ_A: ± 1 ms",
        status,
    )


FITS = (
    a_fit("cold", (6.0, 5.8, 6.2), (11.0, 10.5, 11.5), (12.0, 11.9, 12.1)),
    a_fit("warm", (3.0, 2.0, 4.0), (12.0, 11.0, 13.0), (18.0, 17.5, 18.40004)),
)


def test_ranges_hold_every_interval_and_reach_beyond_by_what_two_records_differ():
    ranges = fitted_ranges(FITS)
    assert ranges["tau_a"] == pytest.approx((0.0, 9.2e-3))  # 2.0 - 3.0 is no time
    assert ranges["tau_b"] == pytest.approx((9.5e-3, 14e-3))
    assert ranges["delay"] == pytest.approx((5.9e-3, 24.40004e-3))
    assert fitted_ranges(FITS, held=5e-3)["delay"] == pytest.approx((10.9e-3, 29.40004e-3))


def test_one_record_s_range_is_its_interval():
    assert fitted_ranges(FITS[:1])["tau_b"] == pytest.approx((10.5e-3, 11.5e-3))
    assert "not how far the machine varies" in spread_in_words(FITS[:1])
    assert "2 records" in spread_in_words(FITS)


@pytest.mark.parametrize(
    ("certainty", "either", "good"),
    [
        (Certainty.DETERMINED, False, True),
        (Certainty.ORDER_UNKNOWN, True, True),
        (Certainty.ORDER_UNKNOWN, False, False),
        (Certainty.ILL_DETERMINED, True, False),
        (Certainty.NOT_CONVERGED, True, False),
    ],
)
def test_a_fit_is_good_whichever_lag_is_whose_if_each_order_is_determined(certainty, either, good):
    found = a_fit("rig", (10, 9, 11), (6, 2, 18), (12, 11, 13), certainty)
    assert replace(found, either_order_determined=either).good is good


@pytest.mark.parametrize(("noise", "good"), [(1e-3, True), (2e-2, False)])
def test_lags_far_apart_may_stand_in_either_order_but_not_in_noise(noise, good):
    """The ends of intervals that hold both orders are as far apart as the lags, five times here."""
    omega = np.geomspace(2, 80, 40)
    value = model(omega, np.array([4e-3, 20e-3, 12e-3]), 0.5)  # equal areas: no order at all
    rng = np.random.default_rng(5)
    value *= 1 + noise * (rng.standard_normal(40) + 1j * rng.standard_normal(40))
    every = np.full(40, np.nan)
    found = fit(FrequencyResponse(omega, value, every, "rig"), 0.5)
    assert found.certainty is Certainty.ORDER_UNKNOWN
    assert found.tau_a.high > 4 * found.tau_a.low
    assert found.good is good


def test_ranges_of_even_draws_reach_the_machine_s_ends_on_average():
    rng = np.random.default_rng(3)
    ends = []
    for _ in range(2000):
        drawn = [(v, v, v) for v in rng.uniform(4.0, 10.0, 5)]
        ends.append(fitted_ranges([a_fit("x", one, one, one) for one in drawn])["tau_a"])
    assert np.mean(ends, axis=0) == pytest.approx((4e-3, 10e-3), rel=0.02)


def test_a_fit_that_did_not_converge_is_left_out():
    bad = a_fit("bad", (6, 0, 90), (6, 0, 90), (6, 0, 90), Certainty.NOT_CONVERGED)
    assert fitted_ranges((*FITS, bad)) == fitted_ranges(FITS)
    with pytest.raises(InputError, match="check the data"):
        fitted_ranges((bad,))


def merged(write_study, text):
    path = write_study({})
    document = tomlkit.parse(path.read_text(encoding="utf-8"))
    document["uncertainty"] = tomlkit.parse(text)["uncertainty"]
    path.write_text(tomlkit.dumps(document), encoding="utf-8")
    return path


@pytest.mark.compiled  # interpreted, it would take minutes
def test_a_study_takes_the_section_and_a_sweep_runs_on_it(write_study, boom):
    text = uncertainty_section(FITS, boom.uncertainty, ["cold.csv"])
    study = load_study(merged(write_study, text), ["uncertainty.points=2"])
    box = study.uncertainty
    assert box.mass == boom.uncertainty.mass
    assert box.tau_a == pytest.approx((0.0, 9.2e-3), abs=1.1e-6)
    assert box.delay == pytest.approx((5.9e-3, 24.41e-3), abs=1.1e-5)  # outwards
    assert box.delay[1] >= 24.40004e-3
    result = sweep(study)
    assert 0 < result.velocity.worst_ratio < 1
    assert result.velocity.at.delay_s in box.delay
    assert "cold: determined" in text


def test_a_nominal_plant_of_the_study_is_kept(load_boom):
    study = load_boom("uncertainty.nominal.mass=30 t", "uncertainty.nominal.delay=12 ms")
    values = tomllib.loads(uncertainty_section(FITS, study.uncertainty, []))["uncertainty"]
    assert values["nominal"] == {"mass": "30000.0 kg", "delay": "0.012 s"}


@pytest.mark.parametrize("low", [0.0, 1.23456e-6])
def test_tiny_and_zero_ends_stay_below_what_was_found(boom, low):
    one = a_fit("one", (6.0, 1e3 * low, 6.2), (11.0, 10.5, 11.5), (12.0, 11.9, 12.1))
    text = uncertainty_section((one,), boom.uncertainty, [])
    least = tomllib.loads(text)["uncertainty"]["tau_a"][0]
    assert float(least.removesuffix(" ms")) <= 1e3 * low


@pytest.mark.compiled  # interpreted, it would take minutes
def test_from_a_measured_file_to_a_sweep_by_box_and_by_member(write_study, tmp_path, boom):
    """The whole way: response, file, fit, section, study with both, sweep."""
    omega = np.geomspace(0.5, 600, 200)
    value = model(omega, np.array([6e-3, 11e-3, 14e-3]), SHARE)
    made = FrequencyResponse(omega, value, np.full(200, np.nan), "rig")
    write_response(tmp_path / "rig.csv", made)
    text = uncertainty_section((fit(made, SHARE),), boom.uncertainty, ["rig.csv"])
    text = text.replace("# measured", "measured")
    study = load_study(merged(write_study, text), ["uncertainty.points=2"])
    assert study.uncertainty.measured_place == "beside"
    result = sweep(study)
    ratios = result.velocity.plant_ratio
    assert ratios[-2:] == pytest.approx([ratios[:-2][:8].max(), ratios[:-2][8:].max()], rel=2e-3)
