"""Slow work runs in a process of its own, is overtaken, and leaves nothing behind."""

import os
import queue
import time

import pytest

from mptune.errors import InputError
from mptune.explore.jobs import Ask, refuse_to_overwrite
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
