"""Kills at random moments, and two at once: nothing half-written, and the end as if undisturbed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
import tomllib
from collections import Counter
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import xarray as xr
from target import gains_of
from test_full_disk import BRIEF, COMMANDS, SETS, lines_of

from mptune.cli.main import BAD_INPUT, INTERRUPTED
from mptune.params.gains import write_gains
from mptune.params.load import load_study

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = [
    pytest.mark.compiled,  # interpreted, it would take minutes
    pytest.mark.skipif(os.name != "posix", reason="signals of POSIX"),
]

SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
KILLS = int(os.environ.get("KILLS", "6"))
_GONE = 15.0  # s, within which workers end with their main process
_PATIENCE = 1800.0  # s, after which a command hangs: other work may share the machine
_DATES = {"date", "gains_date", "content_hash", "gains_hash"}  # of a file: no two runs share them
_CODE = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
_CODE += "from mptune.cli.main import main; main()"


def start(line):
    """Start a command in a session of its own, as a terminal does."""
    return subprocess.Popen(
        [sys.executable, "-c", _CODE, *line],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def members(session: int) -> list[int]:
    """Return the processes of a session that live."""
    found = []
    for name in filter(str.isdecimal, os.listdir("/proc")):  # noqa: PTH208 - names are all it takes
        try:
            with open(f"/proc/{name}/stat", encoding="utf-8") as stream:  # noqa: PTH123 - no path of ours
                state, _, _, owner = stream.read().rpartition(")")[2].split()[:4]
        except OSError:
            continue  # it has just ended
        if int(owner) == session and state != "Z":
            found.append(int(name))
    return found


def all_gone(session: int) -> bool:
    """Return whether every process of a session ends by itself."""
    end = time.monotonic() + _GONE
    while members(session) and time.monotonic() < end:
        time.sleep(0.05)
    left = members(session)
    for one in left:
        os.kill(one, signal.SIGKILL)
    return not left


def killed(line, number, after):
    """Run a command and kill it after so long [s]; return status and stderr."""
    process = start(line)
    try:
        process.wait(after)
    except subprocess.TimeoutExpired:
        process.send_signal(number)
    _, err = process.communicate(timeout=_PATIENCE)
    assert all_gone(process.pid)
    allowed = {0, 1, INTERRUPTED if number == signal.SIGINT else -number}
    assert process.returncode in allowed, err
    assert "Traceback" not in err
    assert "defect" not in err
    return process.returncode


def content(path: Path):
    """Return what a file says, dates apart; raise where it is not whole."""
    kind = path.suffix
    if kind == ".toml":
        return _undated(tomllib.loads(path.read_text(encoding="utf-8")))
    if kind == ".json":
        return _undated(json.loads(path.read_text(encoding="utf-8")))
    if kind == ".nc":
        return xr.load_dataset(path, engine="h5netcdf")
    if kind == ".svg":
        ET.fromstring(path.read_bytes())  # noqa: S314 - our own figure
        return path.read_bytes()
    ends = {".pdf": b"%%EOF", ".html": b"</html>", ".png": b"IEND\xaeB`\x82"}
    assert path.read_bytes().rstrip().endswith(ends.get(kind, b"")), path
    return None


def _undated(values):
    if isinstance(values, dict):
        return {key: _undated(one) for key, one in values.items() if key not in _DATES}
    return values


def results(folder: Path):
    """Return what every file of a folder says, which has to be whole; hidden ones apart."""
    return {
        str(path.relative_to(folder)): content(path)
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not path.name.startswith(".")
    }


def hidden(folder: Path) -> list[str]:
    return [path.name for path in folder.rglob(".*")]


def same(one, other) -> bool:
    if isinstance(one, xr.Dataset):
        return one.identical(other)
    return one == other


def undisturbed(line, folder):
    """Run a command to its end; return its files and the time that it takes [s]."""
    begun = time.monotonic()
    process = start(line)
    _, err = process.communicate(timeout=_PATIENCE)
    assert process.returncode in {0, 1}, err
    assert hidden(folder) == []
    return results(folder), time.monotonic() - begun


def torture(lines, folder, kills, seed, seconds):
    """Kill a command again and again, look at what is there, then let it finish."""
    moments = np.random.default_rng(seed)
    for line in lines:
        for kill in range(kills):
            number = SIGNALS[kill % len(SIGNALS)]
            more = ["--resume"] if line[0] == "campaign" else []
            code = killed([*line, *more], number, moments.uniform(0.3, 1.0) * seconds)
            print(line[0], signal.Signals(number).name, code)
            results(folder)
        more = ["--resume"] if line[0] == "campaign" else []
        process = start([*line, *more])
        _, err = process.communicate(timeout=_PATIENCE)
        assert process.returncode in {0, 1}, err
        assert all_gone(process.pid)


def test_kills_leave_nothing_half_written_and_the_next_run_is_as_if_there_had_been_none(
    study_file, tmp_path
):
    line = ["sweep", str(study_file), *SETS, "--quiet", "--out"]
    wanted, seconds = undisturbed([*line, str(tmp_path / "calm")], tmp_path / "calm")
    killed([*line, str(tmp_path / "out")], signal.SIGKILL, 0.9 * seconds)
    if (tmp_path / "out").exists():
        results(tmp_path / "out")
    found, _ = undisturbed([*line, str(tmp_path / "out")], tmp_path / "out")
    assert found.keys() == wanted.keys()
    assert all(same(found[name], one) for name, one in wanted.items())


@pytest.fixture
def prepared(study_file, tmp_path):
    """A function that returns the lines of a command, writing into a folder."""
    gains = write_gains(tmp_path / "gains.toml", gains_of(load_study(study_file, BRIEF)))

    def lines(command, folder):
        made = lines_of(command, study_file, gains, folder)
        workers = ["--workers", "2"] if command == "campaign" else []
        return [[*line, *workers] for line in made]

    return lines


@pytest.mark.fuzz
@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_killed_again_and_again(prepared, tmp_path, command):
    """Prints command, signal and status of each kill."""
    calm, rough = tmp_path / "calm", tmp_path / "rough"
    begun = time.monotonic()
    for line in prepared(command, calm):
        undisturbed(line, calm)
    seconds = (time.monotonic() - begun) / len(prepared(command, calm))
    wanted = results(calm)
    rough.mkdir()
    torture(prepared(command, rough), rough, KILLS, 7, seconds)
    found = results(rough)
    assert hidden(rough) == []
    if command == "weights":  # the search goes on where it stopped: its trials are others
        assert found.keys() >= wanted.keys()
        return
    assert found.keys() == wanted.keys()
    differ = [name for name, one in wanted.items() if not same(found[name], one)]
    assert not differ


@pytest.mark.fuzz
@pytest.mark.parametrize("command", COMMANDS)
def test_two_at_once_in_one_folder(prepared, tmp_path, command):
    """Both end as they should, or the second is told who has the folder; prints the statuses."""
    calm, shared = tmp_path / "calm", tmp_path / "shared"
    tried = Counter()
    for line, alone in zip(prepared(command, shared), prepared(command, calm), strict=True):
        undisturbed(alone, calm)
        both = [start(line), start(line)]
        said = [one.communicate(timeout=_PATIENCE)[1] for one in both]
        for one, err in zip(both, said, strict=True):
            tried[one.returncode] += 1
            assert one.returncode in {0, 1, BAD_INPUT}, err
            assert all_gone(one.pid)
            if one.returncode == BAD_INPUT:
                assert "is being written to by" in err
    print(command, dict(tried))
    assert tried[0] + tried[1] >= len(prepared(command, calm))
    assert hidden(shared) == []
    found, wanted = results(shared), results(calm)
    assert found.keys() == wanted.keys()
    assert command == "weights" or all(same(found[name], one) for name, one in wanted.items())
