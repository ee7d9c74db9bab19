"""Gains judged elsewhere: the same controller on another model, and what differs."""

import json

import pytest

from mptune.errors import InputError
from mptune.params.gains import GainsFile, accept_margins, gains_for, now, read_gains, write_gains
from mptune.params.headline import Headline
from mptune.params.judged_on import Difference, differences, judged_on

FINER = ("uncertainty.points=9", 'uncertainty.mass=["24500 kg", "60 t"]')


@pytest.fixture
def written(boom, tmp_path):
    """A gains file of the boom study whose gains and feed-forward are not the study's own."""

    def write(**changes):
        gains = {**boom.study.gains.model_dump(), "xi": 0.7}
        values = {
            "study": boom.name,
            "study_hash": boom.hash(),
            "version": "0.1.0",
            "date": now(),
            "margins": "satisfied",
            "closed_loop": "not run",
            "gains": gains,
            "feedforward": {"acceleration_mass": 20e3},
            "figures": {},
            "judged_on": judged_on(boom),
            **changes,
        }
        file = GainsFile.model_validate(values, context={"si": True})
        return write_gains(tmp_path / "gains.toml", file)

    return write


def test_on_its_own_model_nothing_differs(written, boom):
    file, differs = gains_for(boom, written())
    assert differs == ()
    assert file.study_hash == boom.hash()


def test_what_is_chosen_takes_the_place_of_what_the_study_says(written, boom):
    file, _ = gains_for(boom, written())
    put = file.put_over(boom)
    assert put.study.gains.xi == 0.7
    assert put.study.feedforward.acceleration_mass == 20e3
    assert put.hash() == boom.hash()  # what is chosen is no part of the model
    assert put.study.cylinder == boom.study.cylinder


def test_each_key_that_differs_is_said_with_both_values(written, load_boom):
    _, differs = gains_for(load_boom(*FINER, "load.force=5 kN"), written())
    said = {one.key: (one.made_for, one.here) for one in differs}
    assert said["uncertainty.mass"] == ("[24500, 49000]", "[24500, 60000]")
    assert said["load.force"] == ("9700", "5000")
    assert said["uncertainty.points"][1] == "9"
    assert set(said) <= {"uncertainty.mass", "uncertainty.points", "load.force"}


@pytest.mark.parametrize(
    "override",
    [
        "controller.sampling_period=12 ms",
        "controller.position_filter=8 ms",
        "controller.weight_loss=90 N/J",
    ],
)
def test_another_controller_is_refused_with_its_key(written, load_boom, override):
    key = override.split("=")[0]
    with pytest.raises(InputError, match=key) as caught:
        gains_for(load_boom(override), written())
    assert "another controller" in str(caught.value)


def test_the_sensors_are_no_part_of_the_controller(written, load_boom):
    _, differs = gains_for(load_boom("controller.position_noise=10 µm"), written())
    assert "controller.position_noise" in {one.key for one in differs}


def test_a_file_that_does_not_say_what_it_was_made_for_holds_for_its_model_only(
    written, boom, load_boom
):
    early = written(judged_on={})
    assert gains_for(boom, early)[1] == ()
    with pytest.raises(InputError, match="another model"):
        gains_for(load_boom("load.force=5 kN"), early)


def test_the_values_survive_the_file_and_are_plain(written, boom):
    stored = read_gains(written()).judged_on
    assert stored == json.loads(json.dumps(judged_on(boom)))
    assert differences(stored, boom) == ()
    assert stored["controller.sampling_period"] == 0.01
    assert "sha256" in stored["manoeuvre"]


def test_verdict_and_reason_come_back_and_are_told_where_margins_are_refused(written):
    path = written(
        verdict=Headline.ON_PAPER, reason="sampled: 3 plants are unstable", margins="violated"
    )
    file = read_gains(path)
    assert file.verdict is Headline.ON_PAPER
    assert 'verdict = "met on paper only"' in path.read_text(encoding="utf-8")
    with pytest.raises(InputError, match="met on paper only: sampled: 3 plants are unstable"):
        accept_margins(path, file)
    accept_margins(path, file, force=True)


def test_a_difference_reads_well():
    one = Difference("load.force", "9700", "5000")
    assert one.headline == "load.force: 9700 in the gains file, 5000 here"
