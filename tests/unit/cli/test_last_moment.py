"""A Ctrl-C that comes when all is done: the status stays what it was."""

import os
import subprocess
import sys

import pytest

_CODE = """
import atexit, os, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
class Last:
    def __del__(self, kill=os.kill, own=os.getpid(), number=signal.SIGINT):
        kill(own, number)
sys.last = Last()  # torn down after the handlers are
atexit.register(os.kill, os.getpid(), signal.SIGINT)
from mptune.cli.main import main
main()
"""


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_an_interrupt_while_python_ends_changes_no_status():
    command = [sys.executable, "-c", _CODE, "ledger"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert "Eq. 11" in done.stdout
