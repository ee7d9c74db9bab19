"""The simulator compiled beside the sweep: only where it must be, and harmless where it fails."""

import subprocess
import sys
import time

import pytest

from mptune.force.select import decide
from mptune.job import precompile
from mptune.kernel_cache import is_compiled
from mptune.sim.closed_loop import decide_for_more, run_ticks

pytestmark = pytest.mark.compiled  # interpreted, there is nothing to compile


def test_nothing_is_started_where_the_kernels_are_there(monkeypatch, boom):
    monkeypatch.setattr(precompile, "is_compiled", lambda _name: True)
    monkeypatch.setattr(precompile.subprocess, "Popen", None)
    with precompile.precompiling(boom) as ready:
        ready()


@pytest.mark.parametrize("executable", [sys.executable, "/bin/false"])
def test_a_process_that_fails_or_is_not_waited_for_is_gone_afterwards(
    monkeypatch, boom, executable
):
    monkeypatch.setattr(precompile, "is_compiled", lambda _name: False)
    monkeypatch.setattr(precompile.sys, "executable", executable)
    started = []
    popen = precompile.subprocess.Popen

    def noted(*arguments, **options):
        started.append(popen(*arguments, **options))
        return started[0]

    monkeypatch.setattr(precompile.subprocess, "Popen", noted)
    begun = time.monotonic()
    with precompile.precompiling(boom):
        pass
    assert started[0].poll() is not None
    assert time.monotonic() - begun < 5


def test_waiting_has_an_end(monkeypatch, boom):
    monkeypatch.setattr(precompile, "is_compiled", lambda _name: False)
    monkeypatch.setattr(precompile, "_MOST", 0.01)
    with precompile.precompiling(boom) as ready:
        ready()


@pytest.mark.parametrize(
    ("name", "looked_for"),
    [("three-pressure", ["run_ticks"]), ("four-chamber", ["decide_for_more"])],
)
def test_the_kernels_of_as_many_chambers_are_looked_for_and_compiled(
    monkeypatch, load_shape, name, looked_for
):
    asked, commands = [], []
    monkeypatch.setattr(precompile, "is_compiled", lambda one: bool(asked.append(one.__name__)))

    class Ended:
        def __init__(self, command, **_):
            commands.append(command)

        def kill(self):
            pass

        wait = kill

    monkeypatch.setattr(precompile.subprocess, "Popen", Ended)
    with precompile.precompiling(load_shape(name)):
        pass
    assert asked == looked_for  # up to the first that is not there
    assert (precompile._MORE in commands[0]) == (name == "four-chamber")


@pytest.mark.parametrize("more", [False, True])
def test_what_is_compiled_is_what_is_looked_for(more):
    precompile.compile_simulator(more=more)
    assert all(is_compiled(one) for one in ([decide_for_more] if more else [run_ticks, decide]))
    taken = {str(signature) for signature in run_ticks.signatures}
    assert any(("MoreChambers" in one) == more for one in taken)


def test_the_proofs_kernels_are_compiled_too():
    """In a process of its own: here other tests may have compiled them."""
    program = (
        "from mptune.certify.search import search\n"
        "from mptune.job.precompile import compile_proofs\n"
        "assert not search.signatures\n"
        "compile_proofs()\n"
        "assert search.signatures\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
