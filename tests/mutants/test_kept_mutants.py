"""The kept list of mutants cannot rot, and its runner tells a survivor when it sees one."""

from __future__ import annotations

import pytest
from kept import Mutant, kept_mutants
from run import Verdict, judge, verdict_of

EVERY = kept_mutants()


def test_names_are_there_once():
    names = [one.name for one in EVERY]
    assert len(names) == len(set(names)) >= 40


@pytest.mark.parametrize("mutant", EVERY, ids=lambda one: one.name)
def test_a_mutant_changes_one_place_and_names_tests_that_exist(mutant):
    assert mutant.occurrences() == 1
    assert mutant.new != mutant.old
    assert mutant.tests
    assert mutant.missing_tests() == []
    assert len(mutant.why) > 20


@pytest.mark.parametrize(
    "number", ["1", "4", "5", "6", "7", "8", "9", "10", *map(str, range(11, 24))]
)
def test_every_equation_with_code_of_its_own_has_a_mutant(number):
    """Eq. 2 and Eq. 3 are one orifice."""
    names = {one.name.removeprefix("eq-").split("-")[0].lstrip("0") for one in EVERY}
    assert number in names


def test_only_a_failing_test_catches():
    assert verdict_of(1) is Verdict.CAUGHT
    assert verdict_of(0) is Verdict.SURVIVED
    assert verdict_of(None) is Verdict.LATE
    assert {verdict_of(status) for status in (2, 3, 4, 5)} == {Verdict.BROKEN}


@pytest.mark.parametrize(
    ("old", "test"), [("1", "gone.py"), ("2", "test_a.py::test_b"), ("absent", "test_a.py")]
)
def test_a_mutant_without_its_place_or_its_tests_is_stale(tmp_path, old, test):
    (tmp_path / "a.py").write_text("a = 1\nb = 2\nc = 2\n")
    (tmp_path / "test_a.py").write_text("def test_a():\n    pass\n")
    mutant = Mutant("name", "a.py", old, "9", (test,), "because")
    assert judge(mutant, tmp_path, 1.0).verdict is Verdict.STALE
