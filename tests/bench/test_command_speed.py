"""How long the commands take, each as a process of its own; run with ``make bench``."""

import statistics
import subprocess
import sys
import time

import pytest

pytestmark = pytest.mark.bench


def seconds(*arguments):
    """Return the wall time of one command of mptune."""
    start = time.perf_counter()
    command = [sys.executable, "-c", "from mptune.cli.main import main; main()", *arguments]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - start


def test_help_answers_within_0_4_seconds():
    seconds("--help")
    median = statistics.median(seconds("--help") for _ in range(5))
    print(f"\nmptune --help: {1e3 * median:.0f} ms")
    assert median < 0.4


def test_run_takes_less_than_60_seconds_even_when_kernels_are_compiled_anew(
    study_file, tmp_path, monkeypatch
):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    first = seconds("run", str(study_file), "--out", str(tmp_path / "first"), "--quiet")
    second = seconds("run", str(study_file), "--out", str(tmp_path / "second"), "--quiet")
    print(f"\nmptune run: {first:.1f} s compiling, {second:.1f} s with compiled kernels")
    assert first < 60
