"""Every public result says itself in strict JSON."""

import json

import numpy as np
import pytest

from mptune.strict import strict

NAMES = (
    "sweep", "unstable", "condition", "family", "sampled", "check", "link", "tuned", "baseline",
    "front", "front point", "design", "shaped", "move", "case", "verified", "campaign", "panel",
    "identified", "fit", "weights", "job", "judgement", "change", "difference",
)  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_json_is_strict(results, name):
    said = results[name].json()
    text = json.dumps(said, allow_nan=False)
    assert json.loads(text) == said  # no tuples, no keys but texts


def test_what_is_not_finite_is_none(results):
    tuned = results["tuned"].json()
    assert tuned["objective"]["after"]["tracking_index_s"] is None
    assert tuned["objective"]["after"]["load_step_m_per_n"] is None
    assert tuned["blocking"]["least_found"] is None
    assert results["move"].json()["linear_check_index_ms"] is None
    quantiles = results["campaign"].json()["figures"]["valve_switches"]["quantiles"]
    assert set(quantiles.values()) == {None}
    margins = results["unstable"].json()["true_family"]["none"]["force_loop"]
    assert margins["gain_margin"]["worst"] is None


def test_requirements_keep_their_labels_as_names_and_have_keys_beside_them(results):
    said = results["sweep"].json()["requirements"]
    checks = results["sweep"].checks
    assert [one["name"] for one in said] == [check.label for check in checks]
    assert [check.key for check in checks] == [
        "velocity_ratio",
        "position_ratio",
        "unstable_plants",
        "noise_gain",
    ]
    assert said[0]["name"] == "velocity_ratio (Eq. 17)"


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -float("inf"), np.float64("nan")])
def test_strict_reaches_whatever_depth(value):
    held = {"a": (1, [{"b": value, "c": True}]), "d": "nan", "e": 0.0}
    assert strict(held) == {"a": [1, [{"b": None, "c": True}]], "d": "nan", "e": 0.0}
