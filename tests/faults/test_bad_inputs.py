"""Bad inputs of every kind end as the user's fault, in few words, and never as mptune's defect."""

from __future__ import annotations

import time
import warnings
from collections import Counter

import pytest
from spoilt import spoilt

from mptune.campaign.guarantee import runs_table
from mptune.campaign.workers import workers
from mptune.cli.main import status
from mptune.errors import Fault, InputError
from mptune.files import read_text
from mptune.params.gains import read_gains
from mptune.params.load import load_study
from mptune.params.table import read_table

LONGEST = 4096  # bytes of a message
FEWEST = 600
HARMLESS = {"no unit"}  # a 3 is right where a plain number is asked for


def outcome(study_file, bad):
    """Return how a study with one bad input ends: refused, accepted, or what is a defect."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            load_study(study_file, [bad.override])
    except InputError as error:
        size = len(str(error).encode())
        return "refused" if size <= LONGEST else f"a message of {size} bytes"
    except Exception as error:  # noqa: BLE001 - what this test is to find
        return f"{type(error).__name__}: {error}"[:200]
    return "accepted"


@pytest.mark.parametrize("step", [5, pytest.param(1, marks=pytest.mark.fuzz)])
def test_every_key_spoilt_in_every_way_is_refused_in_few_words(study_file, step):
    inputs = spoilt()[::step]
    tried, accepted, defects = Counter(), Counter(), []
    begin = time.perf_counter()
    for bad in inputs:
        tried[bad.kind] += 1
        how = outcome(study_file, bad)
        accepted[bad.kind] += how == "accepted"
        if how not in {"refused", "accepted"}:
            defects.append((bad.kind, bad.override[:60], how))
    for kind, count in tried.items():
        failures = sum(one[0] == kind for one in defects)
        print(f"{kind:28} {count:5} tried {accepted[kind]:5} accepted {failures:5} failures")
    print(f"{len(inputs)} inputs in {time.perf_counter() - begin:.1f} s")
    assert len(inputs) >= FEWEST
    assert defects == []
    assert {kind for kind, count in accepted.items() if count} <= HARMLESS


def test_many_unknown_keys_are_counted_at_once(tmp_path, study_file):
    path = tmp_path / "study.toml"
    many = "".join(f"unknown_{n} = {n}\n" for n in range(20_000))
    path.write_text(many + study_file.read_text(encoding="utf-8"), encoding="utf-8")
    begin = time.process_time()
    with pytest.raises(InputError, match="has 20000 faults, of which") as caught:
        load_study(path)
    assert time.process_time() - begin < 5
    assert len(str(caught.value)) < LONGEST


def test_a_long_value_is_cut_and_a_short_one_is_not():
    line = str(Fault("a" * 10**6, "v" * 10**6, "is wrong", "mend it"))
    assert len(line) < 400
    assert "(1000000 characters)" in line
    assert str(Fault("key", "value", "is wrong", "mend it")) == "`key` = value is wrong; mend it"


def test_of_many_faults_the_first_are_said_and_the_rest_counted():
    error = InputError("file", *(Fault(f"key_{n}", "", "is wrong", "mend it") for n in range(500)))
    lines = str(error).splitlines()
    assert lines[0] == "file: `key_0` is wrong; mend it"
    assert lines[-1] == "and 488 more of the kind; mend these first"
    wide = InputError("ü" * 999, *(Fault("ü" * 999, "ü" * 999, "ü" * 999, "") for _ in range(9)))
    assert len(str(wide).encode()) < LONGEST
    assert len(wide.faults) == 9


@pytest.mark.parametrize("probabilities", [(1e-300, 1e-300), (0.01, 1e-13), (1.0, 0.1)])
def test_what_no_number_of_runs_can_show_is_refused(probabilities):
    with pytest.raises(InputError, match="is not between 1e-12 and 1"):
        runs_table(*probabilities)


@pytest.mark.parametrize(
    "address", ["nonsense", "ucx://host:1", "tcp://", "tcp://h:p", "\0", "a b:1"]
)
def test_what_is_no_address_is_refused_without_a_try(address):
    pytest.importorskip("distributed")
    wanted = r"no address of a scheduler.*tcp://host:8786"
    with pytest.raises(InputError, match=wanted), workers(scheduler=address):
        pass


def test_a_path_that_no_file_can_have(tmp_path):
    for read in (read_text, read_gains, load_study):
        with pytest.raises(InputError, match="no path that a file can have"):
            read("a\0b.toml")
    with pytest.raises(InputError, match="no path that a file can have"):
        read_table(tmp_path / "a\0.csv", "a [m]")


@pytest.mark.parametrize(
    "text",
    [
        "k_p_vel = 2020-01-01",
        "k_p_vel = 1979-05-27T07:32:00Z",
        "k_p_vel = " + "9" * 5000,
        "k_p_vel = [[1]]",
        "k_p_vel = " + "[" * 3000 + "]" * 3000,
        'k_p_vel = "' + "x" * 10**6 + '"',
    ],
)
def test_gains_that_are_no_numbers(tmp_path, text):
    path = tmp_path / "gains.toml"
    path.write_text(f"[gains]\n{text}\n", encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_gains(path)
    assert len(str(caught.value)) < LONGEST


def test_the_command_line_says_bad_input(capsys, study_file, tmp_path):
    lines = [
        ["sweep", str(study_file), "--set", "verification.seeds=[-1]"],
        ["sweep", str(study_file), "--set", "gains.k_p_vel=" + "9" * 5000],
        ["tune", str(study_file), "--set", "a." * 3000 + "a=1"],
        ["campaign", str(study_file), "--runs-for", "1e-300", "1e-300"],
        ["new", "x" * 300, "--in", str(tmp_path)],
    ]
    for line in lines:
        assert status(line) == 2
        err = capsys.readouterr().err
        assert "unforeseen" not in err
        assert 0 < len(err) < LONGEST
    assert list(tmp_path.iterdir()) == []
