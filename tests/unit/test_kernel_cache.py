"""Where compiled kernels are kept: what starts a fresh folder, and what is found again."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from mptune import kernel_cache
from mptune.certify.balls import times
from mptune.sim.closed_loop import run_ticks

PACKAGE = Path(kernel_cache.__file__).parent


@pytest.fixture
def copied(tmp_path):
    """A copy of the package whose files may be changed."""
    package = tmp_path / "mptune"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    return package


@pytest.mark.parametrize(
    ("kernel", "changed", "recompiles"),
    [
        ("sim/closed_loop.py", "sim/closed_loop.py", True),
        ("sim/closed_loop.py", "plant/valve.py", True),  # a kernel that it calls through others
        ("sim/closed_loop.py", "params/packed.py", True),  # tuples that kernels take
        ("sim/closed_loop.py", "arrays.py", True),
        ("sim/closed_loop.py", "certify/balls.py", False),
        ("certify/balls.py", "sim/closed_loop.py", False),
        ("certify/search.py", "certify/balls.py", True),
        ("certify/search.py", "params/pack.py", False),
        ("certify/search.py", "cli/show.py", False),
    ],
)
def test_a_kernel_is_compiled_anew_where_what_it_is_made_of_changes(
    copied, kernel, changed, recompiles
):
    hash_of = kernel_cache.source_hash.__wrapped__
    before = hash_of(copied / kernel, copied)
    assert before == hash_of(PACKAGE / kernel, PACKAGE)
    kernel_cache._imported.cache_clear()
    with (copied / changed).open("a", encoding="utf-8") as file:
        file.write("# changed\n")
    assert (hash_of(copied / kernel, copied) != before) == recompiles


@pytest.mark.compiled
def test_a_kernel_is_known_by_its_file(monkeypatch, tmp_path):
    monkeypatch.setattr(kernel_cache, "_base", lambda: tmp_path)
    assert not kernel_cache.is_compiled(run_ticks)
    folder = kernel_cache.folder_of(run_ticks.py_func)
    folder.mkdir()
    (folder / "closed_loop.run_ticks-143.py311.nbi").touch()
    assert kernel_cache.is_compiled(run_ticks)
    assert not kernel_cache.is_compiled(times)
    monkeypatch.setattr(kernel_cache, "_base", lambda: None)
    assert kernel_cache.is_compiled(times)  # there is no cache to fill


@pytest.mark.compiled
def test_a_copy_of_the_same_text_finds_what_another_compiled(copied, tmp_path):
    program = (
        "from mptune.loops.position import position_controller as g_p\n"
        "g_p(1j, 13.0, 22.0, 42.0, 0.55, 0.006)\n"
        "print(sum(g_p.stats.cache_hits.values()), g_p.stats.cache_path)"
    )

    def run(folder):
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": str(folder)}
        done = subprocess.run(
            [sys.executable, "-c", program],
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        hits, path = done.stdout.split(maxsplit=1)
        return int(hits), path

    hits, place = run(PACKAGE.parent)
    assert hits == 0
    assert run(copied.parent) == (1, place)
