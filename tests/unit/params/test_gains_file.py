"""Gains files: exact, whole, tied to their study."""

from __future__ import annotations

import hashlib
import json
import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mptune.errors import InputError, OutputError
from mptune.params.controller import Feedforward, Gains
from mptune.params.format import GAINS_FORMAT
from mptune.params.gains import GainsFile, accepted_gains, now, read_gains, write_gains

HASH = "a" * 64
EARLY = f"""\
study = "boom"
study_hash = "{HASH}"
uncertainty = ""
version = "0.1.0"
date = "2026-01-01T00:00:00Z"
margins = "satisfied"
closed_loop = "not run"
content_hash = "edc6f59141c730df4f331fc1cab2d8a582866ce60a60c491146f3a4ffd1e869e"

[gains]
k_p_vel = 700000.0
k_p_pos = 13.0
k_i_pos = 22.0
omega = 42.0
xi = 0.55
tau = 0.0123

[feedforward]
acceleration_mass = 20000.0
reference_lag = 0.0
velocity_reference_lag = 0.0

[figures.velocity]
worst_ratio = 0.641
where = [24500.0, 0.0215]
"""


def gains_file(**changes):
    gains = {"k_p_vel": 7e5, "k_p_pos": 13.0, "k_i_pos": 22.0, "omega": 42.0, "xi": 0.55}
    values = {
        "study": "boom",
        "study_hash": HASH,
        "version": "0.1.0",
        "date": now(),
        "margins": "satisfied",
        "closed_loop": "not run",
        "gains": {**gains, "tau": 0.0123},
        "feedforward": {"acceleration_mass": 20e3},
        "figures": {"velocity": {"worst_ratio": 0.641, "where": [24500.0, 0.0215]}},
        **changes,
    }
    return GainsFile.model_validate(values, context={"si": True})


@pytest.fixture
def written(tmp_path):
    path = write_gains(tmp_path / "gains.toml", gains_file())
    return path, path.read_text(encoding="utf-8")


def fault_of(path, text, study_hash=""):
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_gains(path, study_hash)
    assert caught.value.where == str(path)
    (fault,) = caught.value.faults
    assert fault.rule
    assert fault.remedy
    return fault


def within(section):
    """Return numbers within the declared range of each quantity of a section."""
    fields = [section.model_fields[name] for name, *_ in section.quantities()]
    declared = [field.json_schema_extra for field in fields]
    return st.tuples(*(st.floats(one["at_least"], one["at_most"]) for one in declared))


LEADS = [name for name, *_ in Feedforward.quantities()]


@given(within(Gains), within(Feedforward), st.booleans())
def test_gains_come_back_to_the_last_bit(tmp_path_factory, numbers, leads, switch):
    names = ("k_p_vel", "k_p_pos", "k_i_pos", "omega", "xi", "tau")
    feedforward = dict(zip(LEADS, leads, strict=True)) | {"jerk": switch, "adaptive_mass": switch}
    file = gains_file(gains=dict(zip(names, numbers, strict=True)), feedforward=feedforward)
    path = tmp_path_factory.getbasetemp() / "round-trip.toml"
    assert read_gains(write_gains(path, file)) == file


@pytest.mark.parametrize("name", ["", "Kräne №1", 'a "b" \\c', "two\nlines", "\t\x7f\u2028"])
def test_any_name_of_a_study_comes_back(tmp_path, name):
    path = write_gains(tmp_path / "gains.toml", gains_file(study=name))
    assert read_gains(path).study == name


def test_an_estimator_comes_back_and_a_file_without_one_leaves_the_studys(tmp_path, boom):
    chosen = {"kind": "state", "bandwidth": 52.5, "mass": 23_010.0, "reference_injection": True}
    for name, section in (("chosen", chosen), ("least mass", {"kind": "state"}), ("none", None)):
        file = gains_file(estimator=section)
        found = read_gains(write_gains(tmp_path / f"{name}.toml", file))
        assert found == file
        own = found.put_over(boom).study.estimator
        assert own == (boom.study.estimator if section is None else file.estimator)


def test_the_file_is_plain_toml_in_si_under_the_study_s_own_keys(written):
    values = tomllib.loads(written[1])
    assert values["gains"]["k_p_vel"] == 7e5
    assert values["gains"]["tau"] == 0.0123
    assert values["feedforward"]["acceleration_mass"] == 20e3
    assert values["study_hash"] == HASH


def test_every_gain_carries_unit_and_symbol_in_a_comment(written):
    lines = written[1].splitlines()
    for start, unit, symbol in (
        ("k_p_vel", "N s/m", "K_P,vel"),
        ("k_i_pos", "1/s^2", "K_I,pos"),
        ("omega", "rad/s", "ω"),
        ("xi", "-", "ξ"),
        ("acceleration_mass", "kg", "m̂"),
    ):
        (line,) = [line for line in lines if line.startswith(start)]
        assert f"# {unit}, {symbol}," in line


def test_gains_of_the_same_study_are_read(written):
    assert read_gains(written[0], HASH) == gains_file(date=read_gains(written[0]).date)


def test_a_byte_order_mark_is_no_part_of_a_file(written):
    path, _ = written
    plain = read_gains(path)
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert read_gains(path) == plain


def test_gains_of_another_study_are_refused(written):
    fault = fault_of(*written, study_hash="b" * 64)
    assert fault.key == "study_hash"
    assert "another model" in fault.rule
    assert "tune or sweep" in fault.remedy


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("k_p_vel = 700000.0", 'k_p_vel = "700 kN s/m"', "gains.k_p_vel"),
        ("k_p_vel = 700000.0", 'k_p_vel = "700000"', "gains.k_p_vel"),
        ("k_p_vel = 700000.0", 'k_p_vel = "-5"', "gains.k_p_vel"),
        ("k_p_vel = 700000.0", "k_p_vel = true", "gains.k_p_vel"),
        ("k_p_vel = 700000.0", "k_p_vel = -5.0", "gains.k_p_vel"),
        ("k_p_vel = 700000.0", "k_p_vel = nan", "gains.k_p_vel"),
        ("k_p_vel = 700000.0", "k_p_vel = inf", "gains.k_p_vel"),
        ("k_p_vel = 700000.0", "", "gains.k_p_vel"),
        ("k_p_vel = 700000.0", "k_p_vel = 1.0\nk_p_val = 1.0", "gains.k_p_val"),
        ('margins = "satisfied"', 'margins = "fine"', "margins"),
        ('margins = "satisfied"', "", "margins"),
        (f'study_hash = "{HASH}"', 'study_hash = "abc"', "study_hash"),
    ],
)
def test_a_bad_value_is_refused(written, old, new, key):
    path, text = written
    assert old in text
    assert fault_of(path, text.replace(old, new)).key == key


@pytest.mark.parametrize(
    ("landmark", "after"),
    [
        ("[gains]", 0),  # no gains at all
        ("tau = 0.0123", 0),  # one gain missing
        ("tau = 0.0123", 10),  # its last digits missing
        ("[feedforward]", 0),  # the feed-forward missing
        ("acceleration_mass = 20000.0", 21),  # its last digits missing
        ("reference_lag", 0),
    ],
)
def test_a_file_that_was_cut_off_is_refused(written, landmark, after):
    path, text = written
    path.write_text(text[: text.index(landmark) + after], encoding="utf-8")
    with pytest.raises(InputError):
        read_gains(path)


@pytest.mark.parametrize("content", [None, ""])
def test_a_file_that_is_missing_or_empty_is_for_the_tuner_to_write(tmp_path, content):
    path = tmp_path / "gains.toml"
    if content is not None:
        path.write_text(content)
    with pytest.raises(InputError, match="let `mptune tune STUDY` write it") as caught:
        read_gains(path)
    assert "mptune new" not in str(caught.value)


def test_nobody_is_asked_to_write_a_missing_gain_into_a_study(written):
    path, text = written
    fault = fault_of(path, text.replace("omega = 42.0", ""))
    assert (fault.key, fault.remedy) == ("gains.omega", "tune or export it again")


def test_a_file_carries_its_format_and_is_read_without(written):
    path, text = written
    assert tomllib.loads(text)["format"] == GAINS_FORMAT.newest
    numbered = read_gains(path)
    path.write_text(text.replace("format = 1\n", ""), encoding="utf-8")
    assert read_gains(path, HASH) == numbered


def test_a_file_from_before_there_were_formats_is_read(tmp_path):
    """To the letter as the first version wrote it, its hash of its content included."""
    path = tmp_path / "gains.toml"
    path.write_text(EARLY, encoding="utf-8")
    early = read_gains(path, HASH)
    assert (early.gains.tau, early.feedforward.acceleration_mass) == (0.0123, 20e3)
    path.write_text(EARLY.replace("0.0123", "0.0124"), encoding="utf-8")
    with pytest.raises(InputError, match="edited or cut off"):
        read_gains(path)


def test_a_file_that_lacks_a_key_of_later_versions_is_whole_by_its_own_hash(tmp_path):
    path = tmp_path / "gains.toml"
    text = EARLY.replace("velocity_reference_lag = 0.0\n", "")
    values = tomllib.loads(text)
    stated = values.pop("content_hash")
    own = hashlib.sha256(json.dumps(values, sort_keys=True).encode()).hexdigest()
    path.write_text(text.replace(stated, own), encoding="utf-8")
    assert read_gains(path).feedforward.velocity_reference_lag == 0.0
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match="edited or cut off"):
        read_gains(path)


def test_a_newer_format_is_refused_as_such_and_not_as_an_edited_file(written):
    path, text = written
    fault = fault_of(path, text.replace("format = 1\n", "format = 2\nnew = 1\n"))
    assert (fault.key, fault.value, fault.remedy) == ("format", "2", "update mptune")


@pytest.mark.parametrize("value", ['"1"', "1.0", "true", "[1]", "{}"])
def test_a_format_that_is_no_whole_number_is_refused(written, value):
    path, text = written
    fault = fault_of(path, text.replace("format = 1\n", f"format = {value}\n"))
    assert fault.key == "format"
    assert "no whole number" in fault.rule


def test_gains_that_cannot_be_written_are_an_output_error(tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(OutputError):
        write_gains(tmp_path / "file" / "gains.toml", gains_file())


def test_a_controller_accepts_satisfied_margins(boom, tmp_path):
    path = write_gains(tmp_path / "gains.toml", gains_file(study_hash=boom.hash()))
    assert accepted_gains(boom, path) == (read_gains(path), ())


@pytest.mark.parametrize("margins", ["violated", "not run"])
def test_a_controller_refuses_margins_that_are_not_satisfied_unless_forced(boom, tmp_path, margins):
    file = gains_file(margins=margins, study_hash=boom.hash())
    path = write_gains(tmp_path / "gains.toml", file)
    with pytest.raises(InputError) as caught:
        accepted_gains(boom, path)
    (fault,) = caught.value.faults
    assert (fault.key, fault.value) == ("margins", margins)
    assert "--force" in fault.remedy
    assert accepted_gains(boom, path, force=True)[0].margins == margins


def test_force_does_not_make_gains_of_another_model_acceptable_that_are_not_said_to_be(
    boom, written
):
    with pytest.raises(InputError, match="another model"):
        accepted_gains(boom, written[0], force=True)
