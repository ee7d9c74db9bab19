"""The hash that ties a gains file to its study."""

from __future__ import annotations

import pytest

from mptune.params.load import load_study


def test_the_hash_is_that_of_si_values_and_not_of_their_spelling(study_file, boom):
    overrides = ["cylinder.bore=8 cm", 'uncertainty.mass=["24.5 t", "49 t"]', "gains.xi=0.550"]
    assert load_study(study_file, overrides).hash() == boom.hash()


def test_the_hash_does_not_tell_a_litre_from_a_thousand_cubic_centimetres(study_file, boom):
    override = "cylinder.dead_volume_a=400000 mm^3"
    assert load_study(study_file, [override]).hash() == boom.hash()


@pytest.mark.parametrize(
    "override",
    [
        "gains.xi=0.7",
        "feedforward.acceleration_mass=20 t",
        "verification.repeats=3",
        'identification.valve_delays=["5 ms"]',
        "title=another",
        'sources={cylinder="assumed"}',
    ],
)
def test_what_is_no_part_of_the_model_does_not_change_the_hash(study_file, boom, override):
    assert load_study(study_file, [override]).hash() == boom.hash()


@pytest.mark.parametrize(
    "override",
    [
        "cylinder.bore=81 mm",
        "controller.sampling_period=12 ms",
        'uncertainty.mass=["24500 kg", "50 t"]',
        "uncertainty.nominal.mass=30 t",
        "model.measurement_path=filters",
    ],
)
def test_the_model_changes_the_hash(study_file, boom, override):
    assert load_study(study_file, [override]).hash() != boom.hash()


def test_each_uncertainty_set_has_its_own_hash(study_file, boom):
    assert load_study(study_file, uncertainty="section-5-1").hash() != boom.hash()


def test_a_set_that_is_not_chosen_does_not_change_the_hash(study_file, boom):
    override = 'uncertainty.sets.section-5-1.mass=["1 t", "2 t"]'
    assert load_study(study_file, [override]).hash() == boom.hash()


def test_a_study_is_frozen(boom):
    with pytest.raises(ValueError, match="frozen"):
        boom.study.gains.xi = 1.0
