"""The first minute: what compiling costs, once, beside the same work with kernels at hand."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time

import pytest

pytestmark = [pytest.mark.bench, pytest.mark.trial]


def timed(folder, *command):
    """Run a command with kernels in a folder; return its time and that of its stages."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(folder)}
    environment.pop("NUMBA_NUM_THREADS", None)  # of the tests, which share the cores
    begin = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "mptune.cli", *command, "-v"],
        capture_output=True, text=True, check=False, env=environment,
    )  # fmt: skip
    spent = time.perf_counter() - begin
    assert done.returncode in {0, 1}, done.stderr  # 1: done, and a study's verdict is not met
    stages = re.findall(r"^mptune: (.+): ([\d.]+) s, [\d.]+ s of", done.stderr, re.MULTILINE)
    return spent, {name: float(seconds) for name, seconds in stages}


def cold_and_warm(folder, *command):
    """Time a command on an empty folder of kernels and again; print both, and each stage's."""
    (cold, of_cold), (warm, of_warm) = (timed(folder, *command) for _ in range(2))
    print(f"\n{command[0]}: cold {cold:.1f} s, warm {warm:.1f} s, ratio {cold / warm:.1f}")
    for stage, seconds in of_cold.items():
        print(f"  {stage}: cold {seconds:.1f} s, warm {of_warm[stage]:.1f} s")
    assert list(of_cold) == list(of_warm)
    return warm / cold


def test_a_cold_start_beside_a_warm_one(tmp_path, ratio):
    found = cold_and_warm(tmp_path, "warm")
    ratio("mptune warm: a folder of kernels that is there, over an empty one", found, most=0.5)


def test_a_first_run_beside_the_next(study_file, tmp_path, ratio):
    found = cold_and_warm(tmp_path / "kernels", "run", str(study_file), "--out", str(tmp_path))
    ratio("mptune run: a folder of kernels that is there, over an empty one", found, most=0.5)
