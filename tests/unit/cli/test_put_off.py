"""An interrupt that comes while numba works waits for it; a second one does not."""

import os
import signal
import time

import pytest

from mptune.cli.interrupt import interruptible

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")

WORK = """
def work(times):
    seen = []
    for _ in range(times):
        try:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.05)
            seen.append("done")
        except KeyboardInterrupt:
            seen.append("interrupted")
    return seen
"""


def worker(module):
    space = {"__name__": module, "os": os, "signal": signal, "time": time}
    exec(WORK, space)  # noqa: S102 - a function that seems to stand in another module
    return space["work"]


def test_numba_is_let_finish_first():
    seen = []
    with pytest.raises(KeyboardInterrupt), interruptible():  # noqa: PT012
        seen += worker("numba.core.compiler")(1)
        time.sleep(1.0)
        seen.append("went on")
    assert seen == ["done"]


def test_other_work_is_interrupted_at_once():
    with interruptible():
        assert worker("scipy.optimize")(1) == ["interrupted"]


def test_a_second_interrupt_waits_for_nobody():
    with interruptible():
        assert worker("numba.core.compiler")(2)[1] == "interrupted"
        signal.setitimer(signal.ITIMER_REAL, 0)
