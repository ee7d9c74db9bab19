"""One writer at a time: who comes second is told who has the folder, and a kill leaves no claim."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading

import pytest

from mptune.claim import claimed
from mptune.errors import InputError

HOLD = """
import sys, time
from pathlib import Path
from mptune.claim import claimed
with claimed(Path(sys.argv[1]), "campaign", "a campaign of 7 runs, seed 3"):
    print("held", flush=True)
    time.sleep(60)
"""


@pytest.fixture
def holder(tmp_path):
    """Another process that has claimed the folder."""
    command = [sys.executable, "-c", HOLD, str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "held\n"
        yield process
        process.kill()


def claim(folder, task="campaign", what="a campaign of 9 runs, seed 4"):
    with claimed(folder, task, what):
        return [path.name for path in folder.iterdir()]


def test_the_second_is_told_who_has_the_folder(holder, tmp_path):
    with pytest.raises(InputError) as caught:
        claim(tmp_path)
    text = str(caught.value)
    assert str(tmp_path) in text
    assert f"by a campaign of 7 runs, seed 3, process {holder.pid} on " in text
    assert "choose another folder with --out" in text


def test_another_task_may_work_in_the_same_folder(holder, tmp_path):
    assert sorted(claim(tmp_path, "weights", "a search")) == [".campaign.lock", ".weights.lock"]
    assert holder.poll() is None
    assert [path.name for path in tmp_path.iterdir()] == [".campaign.lock"]


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_a_killed_owner_owns_nothing(holder, tmp_path):
    holder.send_signal(signal.SIGKILL)
    holder.wait()
    assert claim(tmp_path) == [".campaign.lock"]
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_left_and_an_error_gets_through(tmp_path):
    with pytest.raises(ValueError, match="mine"), claimed(tmp_path, "run", "a run"):
        raise ValueError("mine")
    assert list(tmp_path.iterdir()) == []
    assert claim(tmp_path) == [".campaign.lock"]


def test_a_folder_that_takes_no_file_is_left_to_the_task_to_complain_of(tmp_path):
    done = []
    with claimed(tmp_path / "not" / "there", "run", "a run"):
        done.append(True)
    assert done


def test_of_many_at_once_one_has_it_at_a_time(tmp_path):
    inside, together, refused = [], [], []

    def work():
        for _ in range(50):
            try:
                with claimed(tmp_path, "run", "a run"):
                    inside.append(1)
                    together.append(len(inside))
                    inside.pop()
            except InputError:
                refused.append(1)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for one in threads:
        one.start()
    for one in threads:
        one.join()
    assert set(together) == {1}
    assert len(together) + len(refused) == 200
    assert list(tmp_path.iterdir()) == []
