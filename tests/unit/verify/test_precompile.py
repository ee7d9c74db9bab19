"""The simulator compiled beside the sweep: only where it must be, and harmless where it fails."""

import sys
import time

import pytest

from mptune import arrays
from mptune.verify import precompile

pytestmark = pytest.mark.compiled  # interpreted, there is nothing to compile


def test_nothing_is_started_where_the_kernels_are_there(monkeypatch):
    monkeypatch.setattr(precompile, "is_compiled", lambda _name: True)
    monkeypatch.setattr(precompile.subprocess, "Popen", None)
    with precompile.precompiling() as ready:
        ready()


@pytest.mark.parametrize("executable", [sys.executable, "/bin/false"])
def test_a_process_that_fails_or_is_not_waited_for_is_gone_afterwards(monkeypatch, executable):
    monkeypatch.setattr(precompile, "is_compiled", lambda _name: False)
    monkeypatch.setattr(precompile.sys, "executable", executable)
    started = []
    popen = precompile.subprocess.Popen

    def noted(*arguments, **options):
        started.append(popen(*arguments, **options))
        return started[0]

    monkeypatch.setattr(precompile.subprocess, "Popen", noted)
    begun = time.monotonic()
    with precompile.precompiling():
        pass
    assert started[0].poll() is not None
    assert time.monotonic() - begun < 5


def test_waiting_has_an_end(monkeypatch):
    monkeypatch.setattr(precompile, "is_compiled", lambda _name: False)
    monkeypatch.setattr(precompile, "_MOST", 0.01)
    with precompile.precompiling() as ready:
        ready()


def test_a_kernel_is_known_by_its_file(monkeypatch, tmp_path):
    monkeypatch.setattr(arrays, "_cache_folder", lambda: str(tmp_path))
    assert not arrays.is_compiled("run_ticks")
    (tmp_path / "sim_1").mkdir()
    (tmp_path / "sim_1" / "closed_loop.run_ticks-143.py311.nbi").touch()
    assert arrays.is_compiled("run_ticks")
    assert not arrays.is_compiled("ticks")
    monkeypatch.setattr(arrays, "_cache_folder", lambda: None)
    assert arrays.is_compiled("anything")  # there is no cache to fill
