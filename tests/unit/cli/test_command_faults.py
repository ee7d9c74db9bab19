"""The commands on bad input, a full disk, and what nobody foresaw: words and exit statuses."""

import pytest

from mptune.cli.main import status

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

CORNERS = ("--set", "uncertainty.points=2")


BAD_VALUES = {
    "wrong unit": ("cylinder.bore", '"80 kg"', "cylinder.bore"),
    "no unit": ("cylinder.bore", "80", "cylinder.bore"),
    "unknown key": ("cylinder.boer", '"80 mm"', "did you mean `bore`"),
    "reversed range": ("uncertainty.mass", '["49 t", "24 t"]', "reversed"),
    "not a number": ("uncertainty.delay", '["nan ms", "14 ms"]', "finite"),
    "empty range": ("uncertainty.tau_a", "[]", "uncertainty.tau_a"),
    "ratio above one": ("requirements.velocity_ratio", "1.5", "velocity_ratio"),
}


@pytest.mark.parametrize("case", BAD_VALUES)
@pytest.mark.parametrize("command", ["sweep", "run"])
def test_bad_value_is_one_clear_message_and_status_2(cli, write_study, tmp_path, case, command):
    key, value, words = BAD_VALUES[case]
    path = write_study({key: value})
    code, out, err = cli(command, study=path)
    assert code == 2
    assert out == ""
    assert words in err
    assert str(path) in err
    assert "Traceback" not in err
    assert len(err.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_empty_file_folder_and_missing_file_are_bad_input(cli, tmp_path):
    empty = tmp_path / "empty.toml"
    empty.write_text("")
    for path, words in ((empty, "is empty"), (tmp_path, "folder"), (tmp_path / "no", "not exist")):
        code, _, err = cli("run", study=path)
        assert code == 2
        assert words in err
        assert "Traceback" not in err


def test_unwritable_output_folder_is_bad_input_before_any_work(cli, tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    code, _, err = cli("run", out=blocked / "sub")
    assert code == 2
    assert "--out" in err
    assert blocked.read_text() == "in the way"


def test_usage_errors_have_status_2(capsys):
    for line in (["sweep"], ["nonsense"], ["run", "x", "--no-such-option"]):
        assert status(line) == 2
    assert "Traceback" not in capsys.readouterr().err


def test_interrupt_has_status_130_and_leaves_nothing(cli, tmp_path, monkeypatch):
    from mptune.job import run as job

    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(job, "tune", interrupted)
    code, _, err = cli("run", *CORNERS)
    assert code == 130
    assert "interrupted" in err
    assert not [path for path in (tmp_path / "out").rglob("*") if path.is_file()]


def test_full_disk_has_status_3_and_leaves_nothing_half_written(cli, tmp_path, monkeypatch):
    import errno
    import os

    def full(_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    code, _, err = cli("tune", *CORNERS)
    assert code == 3
    assert "No space left" in err
    assert not [path for path in (tmp_path / "out").rglob("*") if path.is_file()]


def test_unforeseen_error_has_status_3_and_no_traceback(cli, monkeypatch):
    from mptune.job import sweep as job

    def broken(*_, **__):
        raise ZeroDivisionError("oops")

    monkeypatch.setattr(job, "sweep", broken)
    code, _, err = cli("sweep", *CORNERS)
    assert code == 3
    assert "defect" in err
    assert "Traceback" not in err
