"""How long the commands take, each as a process of its own; run with ``make bench``."""

import resource
import statistics
import subprocess
import sys
import time

import pytest

pytestmark = pytest.mark.bench

BRIEF = ("--set", "verification.repeats=1", "--set", "verification.seeds=[1]")


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


def test_a_run_with_its_kernels_at_hand(study_file, tmp_path):
    """What compiling adds is measured by ``test_first_minute``."""
    seconds("run", str(study_file), "--out", str(tmp_path), "--quiet", *BRIEF)
    before = children()
    spent = seconds("run", str(study_file), "--out", str(tmp_path), "--quiet")
    worked = children() - before
    print(f"\nmptune run: {spent:.1f} s, {worked:.1f} s of the processor")
    assert worked < 120


def children():
    """Return the processor time of all commands so far [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
