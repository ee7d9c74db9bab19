"""The simulator compiled beside the sweep: only where it must be, and harmless where it fails."""

import sys
import time

import pytest

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
