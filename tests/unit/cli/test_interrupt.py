"""A real Ctrl-C during a run: status 130, one line, nothing half-written."""

import os
import signal
import subprocess
import sys
import time

import pytest

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_sigint_ends_a_run_with_130(study_file, tmp_path):
    code = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    code += "from mptune.cli.main import main; main()"
    command = [sys.executable, "-c", code, "run", str(study_file), "--out", str(tmp_path / "out")]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while not (tmp_path / "out").exists():  # the study is read, work begins
        time.sleep(0.02)
        assert process.poll() is None
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=120)
    assert process.returncode == 130, err
    assert "interrupted" in err
    assert "Traceback" not in err
    assert not [path for path in (tmp_path / "out").rglob("*") if path.is_file()]
