"""A disk that fills up, at every moment: status 3, one message, earlier outputs whole, no crash."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import os
import resource
import shutil
import subprocess
import sys
import tomllib
from typing import TYPE_CHECKING

import pytest
from target import gains_of

from mptune import files
from mptune.cli.main import UNFINISHED, status
from mptune.params.gains import write_gains
from mptune.params.load import load_study

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

SIZES = (60, 200, 800)  # kB
_MOVES = 'manoeuvre=[{distance="20 mm", duration="0.5 s", rest="0.2 s"}]'
BRIEF = (
    "uncertainty.points=2",
    "verification.repeats=1",
    "verification.seeds=[1]",
    'verification.masses=["24500 kg"]',
    'verification.oil_bulk_moduli=["1200 MPa"]',
    "identification.frequencies=2",
    'identification.pressures=["5 MPa"]',
    'identification.oil_bulk_moduli=["1200 MPa"]',
    "campaign.runs=4",
    "campaign.chunk=2",
    _MOVES,
)
SETS = [word for one in BRIEF for word in ("--set", one)]


def state(folder: Path) -> dict[str, str]:
    """Return the hash of every file in a folder, hidden ones too."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def errors_in(said: str) -> int:
    """Return how many messages say that a command could not be done; warnings are none."""
    return said.count("mptune: ") - said.count("mptune: warning: ")


@contextlib.contextmanager
def largest_file(size: int) -> Iterator[None]:
    """Let the system refuse any file beyond a size [bytes], as a full disk does."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.fixture
def sweep_command(study_file, tmp_path):
    return ["sweep", str(study_file), *SETS, "--out", str(tmp_path / "out"), "--quiet"]


@pytest.mark.parametrize("size", [1, 200, SIZES[-1]])
def test_a_disk_that_takes_no_more_gives_status_3_and_one_message(
    sweep_command, tmp_path, capsys, size
):
    (tmp_path / "out/boom").mkdir(parents=True)
    (tmp_path / "out/boom/sweep.nc").write_bytes(b"earlier")
    (tmp_path / "out/boom/panels.svg").write_bytes(b"earlier")
    with largest_file(1000 * size if size > 1 else 10):
        code = status(sweep_command)
    said = capsys.readouterr().err
    left = {path.name: path.read_bytes() for path in (tmp_path / "out/boom").iterdir()}
    assert set(left) <= {"sweep.nc", "panels.svg", "certificates.svg"}
    if code != 0:
        assert code == UNFINISHED
        assert errors_in(said) == 1
        assert "nothing was changed" in said or "nothing was left half-written" in said
        assert "earlier" in repr(left)
    for name, content in left.items():
        begins = {".nc": (b"\x89HDF",), ".svg": (b"<?xml",)}[f".{name.partition('.')[2]}"]
        assert content == b"earlier" or content.startswith(begins)
    assert code == (0 if size == SIZES[-1] else UNFINISHED)


@pytest.mark.parametrize("moment", [2, 3])
def test_each_file_s_moment(sweep_command, tmp_path, capsys, monkeypatch, moment):
    """The disk is full as the n-th file is flushed: those before it are whole."""
    flushed, calls = os.fsync, []

    def full(descriptor):
        calls.append(descriptor)
        if len(calls) == moment:
            raise OSError(errno.ENOSPC, "No space left on device")
        flushed(descriptor)

    monkeypatch.setattr(files.os, "fsync", full)
    assert status(sweep_command) == UNFINISHED
    assert errors_in(capsys.readouterr().err) == 1
    names = ["sweep.nc", "panels.svg", "certificates.svg"][: moment - 1]
    assert sorted(state(tmp_path / "out/boom")) == sorted(names)


def test_a_full_temporary_folder_is_no_defect(study_file, capsys, monkeypatch):
    def full(*_arguments, **_options):
        raise OSError(errno.ENOSPC, "No space left on device", "a.svg")

    monkeypatch.setattr("mptune.params.load.load_study", full)
    assert status(["sweep", str(study_file)]) == UNFINISHED
    said = capsys.readouterr().err
    assert "free some space" in said
    assert "defect" not in said


COMMANDS = (
    "sweep",
    "tune",
    "verify",
    "run",
    "identify",
    "campaign",
    "weights",
    "compare",
    "export",
)
TARGETS = ("toml", "json", "c", "st", "fmu")


def lines_of(command, study_file, gains, out):
    """Return the command lines that try a command in a folder."""
    ends = ["--out", str(out), "--quiet"]
    if command == "export":
        return [
            ["export", str(gains), "--to", to, "--study", str(study_file), "--force", *SETS, *ends]
            for to in TARGETS
        ]
    if command == "compare":
        return [["compare", str(study_file), str(gains), *SETS, *ends]]
    more = {"weights": ["--trials", "4"], "verify": ["--force"]}.get(command, [])
    return [[command, str(study_file), *SETS, *more, *ends]]


@pytest.fixture
def mounted(tmp_path):
    """A function that mounts a small disk; it is taken off again."""
    made = []

    def mount(size):
        place = tmp_path / f"disk{size}"
        place.mkdir()
        command = [shutil.which("mount"), "-t", "tmpfs", "-o", f"size={size}k", "tmpfs", str(place)]
        if subprocess.run(command, capture_output=True, check=False).returncode:
            pytest.skip("mounting is not allowed here")
        made.append(place)
        return place

    yield mount
    for place in made:
        subprocess.run([shutil.which("umount"), str(place)], check=True)


@pytest.mark.fuzz
@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_on_a_small_disk(study_file, mounted, tmp_path, command):
    """Prints command, size, status and what was left; twice each: on an empty disk, and again."""
    study = load_study(study_file, BRIEF)
    gains = write_gains(tmp_path / "gains.toml", gains_of(study))
    for size in SIZES:
        out = mounted(size)
        for line in lines_of(command, study_file, gains, out):
            for again in (False, True):
                more = ["--resume"] if again and command == "campaign" else []
                before = state(out)
                done = subprocess.run(
                    [sys.executable, "-m", "mptune.cli", *line, *more],
                    capture_output=True, text=True, check=False,
                )  # fmt: skip
                after = state(out)
                print(
                    command,
                    line[3] if command == "export" else "",
                    size,
                    done.returncode,
                    len(after),
                )
                assert done.returncode in {0, 1, UNFINISHED}, done.stderr
                assert "Traceback" not in done.stderr
                assert "defect" not in done.stderr
                if done.returncode == UNFINISHED:
                    assert errors_in(done.stderr) == 1, done.stderr
                    assert before.keys() <= after.keys() | {f"boom/{command}.nc"}
                assert not [name for name in after if ".part" in name]
                for name in after:
                    if name.endswith(".toml"):
                        tomllib.loads((out / name).read_text(encoding="utf-8"))
