"""Slow work runs in a process of its own, is overtaken, and leaves nothing behind."""

import os
import queue
import shutil
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

from mptune.errors import InputError
from mptune.explore.jobs import Ask, refuse_to_overwrite
from mptune.explore.library import Library
from mptune.explore.slow_work import SlowWork
from mptune.explore.worker import Worker


def running(number):
    try:
        os.kill(number, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.mark.compiled
def test_a_job_is_overtaken_and_its_process_ends(tmp_path, study_file):
    told = queue.Queue()
    worker = Worker(told.put)
    heard = []
    try:
        worker.start("certified", (Ask(study_file, (), ""),), lambda one: heard.append("first"))
        first = worker.process_id
        missing = Ask(tmp_path / "none.toml", (), "")
        worker.start("certified", (missing,), heard.append)
        assert worker.process_id != first
        assert not running(first)
        end = time.monotonic() + 30
        while worker.busy and time.monotonic() < end:
            told.get(timeout=30)()
        assert [one.what for one in heard] == ["progress", "failed"]
        assert "does not exist" in heard[-1].content
        second = worker.process_id
    finally:
        worker.end()
    assert not running(second)
    assert not worker.busy


def test_no_file_is_written_over_unasked(tmp_path):
    path = tmp_path / "gains.toml"
    refuse_to_overwrite(path, over=False)
    path.write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match="exists"):
        refuse_to_overwrite(path, over=False)
    refuse_to_overwrite(path, over=True)
    with pytest.raises(InputError, match=r"\.toml"):
        refuse_to_overwrite(tmp_path / "gains.py", over=True)


NO_PATHS = ["\0.toml", "a" * 300 + ".toml", "b" * 5000 + "/a.toml", "\ud800.toml"]


@pytest.mark.parametrize("text", NO_PATHS, ids=range(len(NO_PATHS)))
def test_what_no_file_can_be_called_is_said_on_the_page(text):
    with pytest.raises(InputError, match="no path that a file can have"):
        refuse_to_overwrite(Path(text), over=False)
    said = SimpleNamespace(object="")
    page = SimpleNamespace(
        gains_path=SimpleNamespace(value=text), over=SimpleNamespace(visible=False), message=said
    )
    slow = SlowWork(page, lambda action: action())
    slow.save(None, lambda: None, over=False)
    slow.close()
    assert "no path that a file can have" in said.object
    assert not slow.worker.busy


@pytest.mark.skipif(os.name != "posix", reason="names of POSIX")
def test_neighbours_of_any_name_are_offered_under_one_that_a_page_can_show(tmp_path, study_file):
    for name in (b"boom", b"\xff\xfe", b"<b>", b"a\nb"):
        folder = tmp_path / os.fsdecode(name)
        folder.mkdir()
        shutil.copy(study_file, folder / "study.toml")
    library = Library.around(tmp_path / "boom" / "study.toml")
    assert len(library.names) == 4
    for name in library.names:
        assert name.encode().isascii()
        assert name.isprintable()
        assert "<" not in name
        assert library.load(name, "").name == name
