"""Apply each kept mutant in turn and show that its tests catch it.

``make mutants``, or ``python tests/mutants/run.py [NAME …]`` for a chosen few; a name may be the
beginning of several. Exit status 0 where every mutant is caught, 1 where one is not, 2 where a name
is not known or the tests fail on the tree as it stands.

Everything happens in one temporary copy of the tree. First all named tests run unchanged: a test
that fails anyway catches nothing. Then each mutant is written into the copy, its tests run until
the first failure, and its file is put back. A mutant counts as caught where a test fails, not where
the tests cannot be run or take longer than the budget.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from kept import ROOT, Mutant, kept_mutants

BUDGET = 120.0  # s, of one mutant's tests
_FIRST_RUN = 900.0  # s, of all tests unchanged: kernels may have to be compiled
_LEFT_OUT = (".*", "__pycache__", "*.egg-info", "reports", "build", "site")
_BLAMED = re.compile(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", re.MULTILINE)


class Verdict(StrEnum):
    """What became of a mutant."""

    CAUGHT = "caught"  # some test failed
    SURVIVED = "SURVIVED"  # every test passed
    STALE = "STALE"  # its old text no longer occurs exactly once, or a test is gone
    BROKEN = "BROKEN"  # the tests could not be run at all
    LATE = "LATE"  # no verdict within the budget


@dataclass(frozen=True)
class Outcome:
    """A mutant's verdict, the test that caught it, and how long that took [s]."""

    mutant: Mutant
    verdict: Verdict
    caught_by: str
    seconds: float


def verdict_of(status: int | None) -> Verdict:
    """Return the verdict from pytest's exit status, None where it ran out of time."""
    if status is None:
        return Verdict.LATE
    return {0: Verdict.SURVIVED, 1: Verdict.CAUGHT}.get(status, Verdict.BROKEN)


def run_tests(
    copy: Path, tests: tuple[str, ...], budget: float, *, compiled: bool
) -> tuple[int | None, str]:
    """Run tests in the copy; return pytest's exit status, None beyond the budget, and its words."""
    environment = {
        **os.environ,
        "PYTHONPATH": str(copy),  # the copy's mptune, wherever another one is installed
        "PYTHONDONTWRITEBYTECODE": "1",  # two changes of one second and size would look the same
        "NUMBA_CACHE_DIR": str(copy / ".kernels"),
        "NUMBA_DISABLE_JIT": "0" if compiled else "1",
        "HYPOTHESIS_PROFILE": "unshrunk",
    }
    marks = "not bench" if compiled else "not bench and not compiled"
    options = ["-x", "-q", "--tb=no", "-p", "no:cacheprovider", "-m", marks]
    command = [sys.executable, "-m", "pytest", *options, *tests]
    try:
        done = subprocess.run(
            command, cwd=copy, env=environment, timeout=budget, capture_output=True, text=True,
            check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return None, ""
    return done.returncode, done.stdout + done.stderr


def judge(mutant: Mutant, copy: Path, budget: float) -> Outcome:
    """Apply one mutant in the copy, run its tests and put its file back."""
    if mutant.occurrences(copy) != 1 or mutant.missing_tests(copy):
        return Outcome(mutant, Verdict.STALE, "", 0.0)
    path, original = copy / mutant.file, ROOT / mutant.file
    start = time.perf_counter()
    path.write_text(mutant.applied(path.read_text(encoding="utf-8")), encoding="utf-8")
    try:
        status, words = run_tests(copy, mutant.tests, budget, compiled=mutant.compiled)
    finally:
        shutil.copy2(original, path)  # with its time: kernels of the unchanged tree stay compiled
    found = _BLAMED.search(words)
    caught_by = found[1].removeprefix("tests/") if found else ""
    return Outcome(mutant, verdict_of(status), caught_by, time.perf_counter() - start)


def passes_unchanged(mutants: list[Mutant], copy: Path) -> bool:
    """Run every named test on the tree as it stands, and say which fails."""
    for compiled in (False, True):
        named = [test for one in mutants if one.compiled == compiled for test in one.tests]
        tests = tuple(
            dict.fromkeys(test for test in named if (copy / test.split("::")[0]).exists())
        )
        if not tests:
            continue
        status, words = run_tests(copy, tests, _FIRST_RUN, compiled=compiled)
        if status != 0:
            print(f"The tests do not pass on the tree as it stands:\n{words}")
            return False
    return True


def chosen(names: list[str]) -> list[Mutant]:
    """Return the mutants whose names begin with one of ``names``; all where there are none."""
    every = kept_mutants()
    unknown = [name for name in names if not any(one.name.startswith(name) for one in every)]
    if unknown:
        print(f"no such mutant: {', '.join(unknown)}")
        raise SystemExit(2)
    return [one for one in every if not names or one.name.startswith(tuple(names))]


def main() -> int:
    """Judge the mutants and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="mutants to apply, or how their names begin")
    parser.add_argument("--budget", type=float, default=BUDGET, help="seconds for each mutant")
    options = parser.parse_args()
    mutants = chosen(options.names)
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        copy = Path(folder) / "tree"
        shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(*_LEFT_OUT))
        if not passes_unchanged(mutants, copy):
            return 2
        width = max(len(one.name) for one in mutants)
        outcomes = []
        for mutant in mutants:
            one = judge(mutant, copy, options.budget)
            outcomes.append(one)
            line = f"{mutant.name:{width}}  {one.verdict:8}  {one.seconds:5.1f} s  {one.caught_by}"
            print(line.rstrip(), flush=True)
    missed = [one for one in outcomes if one.verdict is not Verdict.CAUGHT]
    print(f"{len(outcomes) - len(missed)} of {len(outcomes)} mutants caught")
    for one in missed:
        print(f"{one.verdict} {one.mutant.name} ({one.mutant.file}): {one.mutant.why}")
    return 1 if missed else 0


if __name__ == "__main__":
    raise SystemExit(main())
