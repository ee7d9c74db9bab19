"""Files are written whole or not at all, and read with errors that say what to do."""

from __future__ import annotations

import errno
import os
import subprocess
import sys

import pytest

from mptune import files
from mptune.errors import InputError, OutputError
from mptune.files import make_folder, read_text, write_whole


def fault_of(path):
    with pytest.raises(InputError) as caught:
        read_text(path)
    assert caught.value.where == str(path)
    assert str(caught.value).startswith(str(path))
    (fault,) = caught.value.faults
    return fault


def test_text_comes_back_as_written(tmp_path):
    path = write_whole(tmp_path / "a.txt", "τ_A = 12.2 ms\n")
    assert read_text(path) == "τ_A = 12.2 ms\n"


def test_bytes_come_back_as_written(tmp_path):
    path = write_whole(tmp_path / "a.bin", b"\x00\xff\r\n")
    assert path.read_bytes() == b"\x00\xff\r\n"


def test_an_earlier_file_is_replaced(tmp_path):
    path = write_whole(tmp_path / "a.txt", "earlier and longer")
    write_whole(path, "later")
    assert path.read_text() == "later"


def test_a_missing_file_says_so(tmp_path):
    fault = fault_of(tmp_path / "none.toml")
    assert "does not exist" in fault.rule
    assert "path" in fault.remedy


def test_a_folder_in_place_of_a_file_says_so(tmp_path):
    fault = fault_of(tmp_path)
    assert "folder" in fault.rule
    assert "file" in fault.remedy


def test_a_path_under_a_file_is_an_input_error(tmp_path):
    (tmp_path / "file").write_text("x")
    assert fault_of(tmp_path / "file" / "study.toml").rule


@pytest.mark.skipif(os.name != "posix", reason="pipes and devices with names of POSIX")
def test_what_has_no_end_is_not_read(tmp_path):
    """A study may name any file as its base or table: a pipe would wait, a device never end."""
    os.mkfifo(tmp_path / "pipe.toml")
    for path in (tmp_path / "pipe.toml", "/dev/zero"):
        with pytest.raises(InputError, match="is no regular file"):
            read_text(path)


def test_what_is_too_large_to_be_text_is_not_read(tmp_path):
    path = tmp_path / "table.csv"
    with path.open("wb") as stream:
        stream.truncate(10**12)  # a hole: it takes no room
    assert "1000000 MB" in fault_of(path).rule


@pytest.mark.parametrize("content", [b"", b" \n\t\r\n"])
def test_an_empty_file_says_so(tmp_path, content):
    path = tmp_path / "empty.toml"
    path.write_bytes(content)
    assert "empty" in fault_of(path).rule


@pytest.mark.parametrize("content", [b"caf\xe9", "bore".encode("utf-16"), b"\x89PNG\r\n\x1a\n"])
def test_a_file_that_is_not_utf_8_says_so(tmp_path, content):
    path = tmp_path / "study.toml"
    path.write_bytes(content)
    fault = fault_of(path)
    assert "UTF-8" in fault.rule
    assert "UTF-8" in fault.remedy


@pytest.fixture
def full_disk(monkeypatch):
    def fsync(descriptor):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", fsync)


@pytest.mark.usefixtures("full_disk")
def test_a_full_disk_leaves_the_earlier_file_and_no_litter(tmp_path):
    path = tmp_path / "gains.toml"
    path.write_text("earlier")
    with pytest.raises(OutputError, match="No space left") as caught:
        write_whole(path, "later")
    assert str(path) in str(caught.value)
    assert path.read_text() == "earlier"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.usefixtures("full_disk")
def test_a_full_disk_leaves_nothing_where_nothing_was(tmp_path):
    with pytest.raises(OutputError):
        write_whole(tmp_path / "gains.toml", "new")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("interruption", [KeyboardInterrupt, ValueError])
def test_an_interrupted_write_leaves_the_earlier_file_and_no_litter(
    tmp_path, monkeypatch, interruption
):
    path = tmp_path / "trace.nc"
    path.write_text("earlier")

    def interrupted(_descriptor):
        raise interruption

    monkeypatch.setattr(files.os, "fsync", interrupted)
    with pytest.raises(interruption):
        write_whole(path, "half")
    assert path.read_text() == "earlier"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("place", ["file/sub", "missing/sub", "folder"])
def test_a_place_that_cannot_be_written_is_an_output_error(tmp_path, place):
    (tmp_path / "file").write_text("x")
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "inside").write_text("x")
    with pytest.raises(OutputError, match=place):
        write_whole(tmp_path / place, "content")
    assert (tmp_path / "file").read_text() == "x"
    assert not list(tmp_path.glob(".*"))


def test_a_folder_for_results_is_made_with_its_parents(tmp_path):
    assert make_folder(tmp_path / "a" / "b").is_dir()
    assert list((tmp_path / "a" / "b").iterdir()) == []


def test_a_folder_for_results_under_a_file_is_an_input_error(tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match="choose another folder"):
        make_folder(tmp_path / "file" / "sub")


@pytest.mark.skipif(os.name != "posix", reason="processes of POSIX")
def test_what_a_killed_writer_has_left_is_cleared_by_the_next_and_a_living_one_s_is_not(
    tmp_path, monkeypatch
):
    path = tmp_path / "gains.toml"
    parts = {}

    def seen(_descriptor):
        (parts["own"],) = tmp_path.glob(".*")

    monkeypatch.setattr(files.os, "fsync", seen)
    write_whole(path, "one")
    with subprocess.Popen([sys.executable, "-c", ""]) as dead:
        dead.wait()
    mark = f"-{os.getpid()}-"
    left = parts["own"].with_name(parts["own"].name.replace(mark, f"-{dead.pid}-"))
    other = tmp_path / left.name.replace("gains", "gains-verified")
    living = parts["own"].with_name(parts["own"].name.replace(mark, f"-{os.getppid()}-"))
    for one in (left, other, living):
        one.write_text("half")
    monkeypatch.undo()
    write_whole(path, "two")
    assert sorted(tmp_path.iterdir()) == sorted([path, other, living])
    assert path.read_text() == "two"
