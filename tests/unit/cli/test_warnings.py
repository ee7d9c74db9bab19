"""What is doubtful about a study: on stderr for people, in JSON for programs, never in the way."""

import json

import pytest

from mptune.cli.main import status

CORNERS = ("--set", "uncertainty.points=2")
DERIVED = (
    "--set", 'uncertainty.delay="derived"', "--set", 'uncertainty.delay_as_it_runs="derived"',
)  # fmt: skip


@pytest.fixture
def sweep(study_file, tmp_path, capsys):
    def run(*arguments):
        line = ["sweep", str(study_file), "--out", str(tmp_path), "-q", "--json", *CORNERS]
        code = status([*line, *arguments])
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run


@pytest.mark.compiled
def test_a_doubt_is_said_on_stderr_and_in_json(sweep, boom):
    code, out, err = sweep()
    (warning,) = json.loads(out)["warnings"]
    assert code == 0
    assert warning == boom.doubts[0].json()
    assert warning["values"]["uncertainty.delay"] == "11–21.5 ms"
    assert err.count("mptune: warning: ") == 1
    assert str(boom.doubts[0]) in err


@pytest.mark.compiled
def test_a_study_without_doubts_says_nothing(sweep):
    _, out, err = sweep(*DERIVED)
    assert json.loads(out)["warnings"] == []
    assert "warning" not in err


def test_what_cannot_be_simulated_is_refused_before_the_sweep(sweep):
    code, out, err = sweep("--set", "controller.sampling_period=8 ms")
    assert (code, out) == (2, "")
    assert "`valves.delay` = 8 ms" in err
    assert "controller.sampling_period = 8 ms" in err
