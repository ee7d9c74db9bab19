"""The number of a file's format: older ones are read, newer ones refused, and no hash holds it."""

from __future__ import annotations

import tomllib

import pytest

from mptune.errors import InputError
from mptune.params.format import STUDY_FORMAT, Format
from mptune.params.load import load_study
from mptune.params.template import write_template

SECOND = Format(newest=3, renew="write it anew", oldest=2)
BAD = ['"1"', "1.0", "true", "[1]", "{}"]


@pytest.mark.parametrize("number", [2, 3])
def test_the_newest_and_older_ones_that_are_still_readable_are_read(tmp_path, number):
    values = {"format": number, "title": "x"}
    assert SECOND.take(tmp_path, values) == number
    assert values == {"title": "x"}


def test_a_file_without_a_number_is_of_the_first_format(tmp_path):
    assert Format(newest=3, renew="").take(tmp_path, {}) == 1
    with pytest.raises(InputError, match="`format` = 1 is older than 2"):
        SECOND.take(tmp_path, {})


@pytest.mark.parametrize(
    ("number", "rule", "remedy"),
    [
        (4, "newer than 3", "update mptune"),
        (10**30, "newer than 3", "update mptune"),
        (1, "older than 2", "write it anew"),
        (0, "older than 2", "write it anew"),
        (-1, "older than 2", "write it anew"),
        (2.0, "no whole number", "format = 3"),
        ("2", "no whole number", "format = 3"),
        (True, "no whole number", "format = 3"),
        (None, "no whole number", "format = 3"),
    ],
)
def test_any_other_number_is_refused_with_what_to_do(tmp_path, number, rule, remedy):
    with pytest.raises(InputError) as caught:
        SECOND.take(tmp_path / "a.toml", {"format": number})
    (fault,) = caught.value.faults
    assert caught.value.where == str(tmp_path / "a.toml")
    assert (fault.key, fault.value) == ("format", repr(number))
    assert rule in fault.rule
    assert remedy in fault.remedy


# Studies.


@pytest.fixture
def numbered(tmp_path, study_file):
    def write(line):
        text = study_file.read_text(encoding="utf-8")
        assert "\nformat = 1\n" in text
        path = tmp_path / "study.toml"
        path.write_text(text.replace("\nformat = 1\n", f"\n{line}\n"), encoding="utf-8")
        return path

    return write


def test_a_study_without_a_number_is_read_and_is_the_same(numbered, boom):
    assert load_study(numbered("")).hash() == boom.hash()


@pytest.mark.parametrize(
    "line", [f"format = {STUDY_FORMAT.newest + 1}\nwhat_is_this = 1", "format = 0"]
)
def test_a_study_of_a_format_not_known_is_refused_before_all_else(numbered, line):
    with pytest.raises(InputError, match="`format` =") as caught:
        load_study(numbered(line))
    assert len(caught.value.faults) == 1


@pytest.mark.parametrize("value", BAD)
def test_a_number_of_another_kind_is_refused_in_a_study(numbered, value):
    with pytest.raises(InputError, match=r"`format` = .* is no whole number"):
        load_study(numbered(f"format = {value}"))


def test_a_study_to_start_from_is_of_the_newest_format(tmp_path):
    path = write_template(tmp_path, "crane")
    assert tomllib.loads(path.read_text(encoding="utf-8"))["format"] == STUDY_FORMAT.newest
    assert load_study(path).name == "crane"


def test_a_study_to_start_from_may_be_given_a_base(tmp_path, study_file):
    path = write_template(tmp_path, "crane")
    lines = path.read_text(encoding="utf-8").splitlines()
    head = [line for line in lines if line.startswith(("# base = ", "format = "))]
    marked = head[1].removeprefix("# ").replace("../boom/study.toml", str(study_file))
    path.write_text(f"{head[0]}\n{marked}\n", encoding="utf-8")
    assert load_study(path).study.cylinder.bore == 0.08


@pytest.mark.parametrize("name", ["boom", "boom-2dof"])
def test_every_study_here_is_of_the_newest_format(root, name):
    text = (root / "studies" / name / "study.toml").read_text(encoding="utf-8")
    assert tomllib.loads(text)["format"] == STUDY_FORMAT.newest
