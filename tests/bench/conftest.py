"""The ratios that benches measure: held against what is asked of them, and left as a table.

``reports/bench.md`` has them with machine and date. ``MPTUNE_BENCH_SLACK`` makes what is asked so
many times easier: a guard for machines that share their cores with others.
"""

from __future__ import annotations

import os
import platform
import time
from pathlib import Path

import numba
import pytest

SLACK = float(os.environ.get("MPTUNE_BENCH_SLACK", "1"))
TABLE = Path(__file__).parents[2] / "reports" / "bench.md"
ROWS = pytest.StashKey[list[str]]()


@pytest.fixture
def ratio(request):
    """Note a ratio, and hold it against the least or the most that is asked of it."""

    def note(what, value, *, least=None, most=None):
        asked = f"at least {least:g}" if least is not None else f"at most {most:g}"
        rows = request.config.stash.setdefault(ROWS, [])
        rows.append(f"| {what} | {value:.3g} | {asked} |")
        print(f"\n{what}: {value:.3g}, {asked}")
        if least is not None:
            assert value >= least / SLACK
        if most is not None:
            assert value <= most * SLACK

    return note


def pytest_sessionfinish(session):
    rows = session.config.stash.get(ROWS, [])
    if not rows:
        return
    versions = f"Python {platform.python_version()}, numba {numba.__version__}"
    head = [f"Measured {time.strftime('%Y-%m-%d %H:%M')} on {machine()}, {versions}."]
    if SLACK != 1:
        head.append(f"The guard asks {SLACK:g} times less than is written here.")
    head += ["", "| ratio | measured | asked |", "|---|---|---|"]
    TABLE.parent.mkdir(exist_ok=True)
    TABLE.write_text("\n".join([*head, *rows]) + "\n", encoding="utf-8")
    print(f"\nratios in {TABLE}")


def machine():
    """Return processor, cores, and how busy others keep them."""
    information = Path("/proc/cpuinfo")
    name = platform.processor() or platform.machine()
    if information.is_file():
        for line in information.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                name = line.partition(":")[2].strip()
                break
    load = f", load {os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""
    return f"{name}, {os.cpu_count()} cores{load}"
