"""Colour: on a terminal only, and never where NO_COLOR asks for none."""

import os
import pty
import subprocess
import sys

import pytest

SCRIPT = """
from mptune.cli.show_run import outcome
outcome(met={met})
"""


def on_terminal(met, **environment):
    """Return what the outcome prints where stdout is a terminal."""
    main, other = pty.openpty()
    variables = {k: v for k, v in os.environ.items() if k not in {"NO_COLOR", "FORCE_COLOR"}}
    variables |= {"TERM": "xterm-256color", **environment}
    code = SCRIPT.format(met=met)
    subprocess.run([sys.executable, "-c", code], stdout=other, env=variables, check=True)
    os.close(other)
    text = b""
    try:
        while part := os.read(main, 4096):
            text += part
    except OSError:
        pass  # the end of a closed terminal
    os.close(main)
    return text.decode()


def test_a_terminal_gets_verdicts_in_colour():
    assert "\x1b[32m" in on_terminal(met=True)
    assert "\x1b[1;31m" in on_terminal(met=False)


def test_no_color_is_obeyed():
    text = on_terminal(met=True, NO_COLOR="1")
    assert "\x1b[3" not in text
    assert "Every requirement is met." in text


@pytest.mark.parametrize("met", [True, False])
def test_a_pipe_gets_plain_text(met):
    command = [sys.executable, "-c", SCRIPT.format(met=met)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "\x1b" not in done.stdout
    assert done.stdout.strip().endswith("met.")
