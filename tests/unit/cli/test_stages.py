"""Progress in plain lines, and how long stages took."""

from __future__ import annotations

import io
import re
import sys
import time

import pytest

from mptune.cli.journey import ORDER
from mptune.cli.main import status
from mptune.cli.stages import Stages, be_verbose, telling


class Clock:
    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return Clock()


def test_a_line_names_the_stage_its_share_and_the_time_that_is_left(clock):
    stages = Stages(clock)
    assert stages.line() == "starting, 0 s"
    stages.take("sweep", 0.0)
    clock.now += 5
    stages.take("tune", 0.0)
    clock.now += 6
    assert stages.line() == "tune, 11 s"  # nothing to estimate from
    stages.take("tune", 0.25)
    assert stages.line() == "tune, 11 s: 25 % of it, about 18 s left of it"


def test_the_times_of_a_stage_that_comes_again_add_up(clock):
    stages = Stages(clock)
    for stage, spent in (("chain", 2.0), ("verify", 11.0), ("chain", 3.0)):
        stages.take(stage, 0.0)
        clock.now += spent
    spent = {stage: times[0] for stage, times in stages.durations().items()}
    assert spent == {"chain": 5.0, "verify": 11.0}


def test_lines_come_while_the_work_goes_on_where_stderr_is_no_terminal(capsys):
    with telling(quiet=False, every=0.02) as stages:
        stages.take("sweep", 0.5)
        time.sleep(0.1)
    assert "mptune: sweep, 0 s: 50 % of it" in capsys.readouterr().err


def test_quiet_tells_nothing(capsys):
    with telling(quiet=True, every=0.01) as stages:
        stages.take("sweep", 0.5)
        time.sleep(0.05)
    assert capsys.readouterr().err == ""


def test_verbose_tells_what_each_stage_took(capsys):
    be_verbose(asked=True)
    try:
        with telling(quiet=True) as stages:
            stages.take("sweep", 1.0)
    finally:
        be_verbose(asked=False)
    assert re.fullmatch(
        r"mptune: sweep: 0\.\d s, 0\.\d s of the processor\n", capsys.readouterr().err
    )


def test_help_lists_commands_in_the_order_of_a_journey_with_whole_sentences(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "60")
    assert status(["--help"]) == 0
    listed = capsys.readouterr().out.split("Commands:\n")[1]
    names = re.findall(r"^  (\w+)", listed, re.MULTILINE)
    assert names == [name for name in ORDER if name in names]
    assert "…" not in listed
    assert "..." not in listed
    entries = re.split(r"\n(?=  \w)", listed.rstrip())
    assert all(entry.endswith(".") for entry in entries)
    assert max(map(len, listed.splitlines())) <= 60


def test_every_command_on_a_study_takes_quiet_and_verbose(capsys):
    for name in set(ORDER) - {"new", "ledger", "warm", "explore"}:
        assert status([name, "--help"]) == 0
        words = capsys.readouterr().out
        assert "-q, --quiet" in words
        assert "-v, --verbose" in words


@pytest.mark.parametrize("missing", [True, False])
def test_a_closed_or_missing_stream_does_not_end_the_work(monkeypatch, missing):
    stream = io.StringIO()
    stream.close()
    monkeypatch.setattr(sys, "stderr", None if missing else stream)
    be_verbose(asked=True)
    try:
        with telling(quiet=False, every=0.01) as stages:
            stages.take("sweep", 0.5)
            time.sleep(0.03)
    finally:
        be_verbose(asked=False)
    assert list(stages.durations()) == ["sweep"]
