"""The first minute: what compiling costs, once, beside the same work with kernels at hand."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time

import pytest

pytestmark = [pytest.mark.bench, pytest.mark.trial]


def warmed(folder):
    """Run ``mptune warm -v`` with kernels in a folder; return its time and that of its stages."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(folder)}
    begin = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "mptune.cli", "warm", "-v"],
        capture_output=True,
        text=True,
        check=True,
        env=environment,
    )
    spent = time.perf_counter() - begin
    stages = re.findall(r"^mptune: (.+): ([\d.]+) s, [\d.]+ s of", done.stderr, re.MULTILINE)
    return spent, {name: float(seconds) for name, seconds in stages}


def test_a_cold_start_beside_a_warm_one(tmp_path, ratio):
    cold, of_cold = warmed(tmp_path)
    warm, of_warm = warmed(tmp_path)
    print(f"cold {cold:.1f} s, warm {warm:.1f} s, ratio {cold / warm:.1f}")
    for stage, seconds in of_cold.items():
        print(f"  {stage}: cold {seconds:.1f} s, warm {of_warm[stage]:.1f} s")
    assert list(of_cold) == list(of_warm)
    ratio(
        "mptune warm: a folder of kernels that is there, over an empty one", warm / cold, most=0.5
    )
