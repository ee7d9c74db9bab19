"""``mptune campaign`` as users run it."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest
from target import gains_of

from mptune.cli.main import status
from mptune.params.gains import write_gains
from mptune.params.judged_on import judged_on

SHORT = (
    *("--set", 'manoeuvre=[{distance="5 mm", duration="0.3 s", rest="0.1 s"}]'),
    *("--set", "campaign.chunk=4"),
    *("--workers", "1"),
)
TEN = ("--set", "campaign.runs=10")


@pytest.fixture
def cli(study_file, tmp_path, capsys):
    def run(*arguments):
        code = status(["campaign", str(study_file), "--out", str(tmp_path), *arguments])
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run


def test_how_many_runs_are_needed_is_said_without_running_any(cli, tmp_path):
    code, out, _ = cli("--runs-for", "0.01", "1e-6", "--json")
    assert code == 0
    assert json.loads(out)["runs_by_failures"]["0"] == 1375
    assert not list(tmp_path.rglob("*.nc"))
    assert "1375 runs" in cli("--runs-for", "0.01", "1e-6")[1]


def test_bad_probabilities_end_with_2(cli):
    code, _, err = cli("--runs-for", "0", "1e-6")
    assert code == 2
    assert "EPSILON" in err


@pytest.mark.compiled
def test_json_stands_alone_and_a_run_is_replayed_with_the_same_figures(cli, tmp_path):
    code, out, _ = cli(*SHORT, *TEN, "--json")
    values = json.loads(out)
    assert code == 0
    assert out.count("\n") == 1
    assert values["runs"] == 10
    assert (tmp_path / "boom" / "campaign.nc").exists()
    assert (tmp_path / "boom" / "campaign.svg").exists()
    worst = values["figures"]["performance_index_ms"]
    code, out, _ = cli(*SHORT, *TEN, "--replay", str(worst["worst_run"]), "--json")
    again = json.loads(out)
    assert code == 0
    assert again["performance_index_ms"] == worst["worst"]
    assert again["parameters"] == worst["worst_at"]


@pytest.mark.compiled
def test_tables_say_what_is_guaranteed_and_for_sobol_that_nothing_is(cli):
    assert "0 of 10 failed" in cli(*SHORT, *TEN)[1]
    assert "No guarantee" in cli(*SHORT, *TEN, "--set", "campaign.method=sobol")[1]


@pytest.mark.compiled
def test_a_failed_run_ends_with_status_1(cli):
    code, out, _ = cli(*SHORT, *TEN, "--set", "campaign.limits.performance_index=1 ms")
    assert code == 1
    assert "performance_index above its limit" in out


@pytest.mark.compiled
def test_the_worst_machine_is_searched_and_shown(cli, tmp_path):
    code, out, _ = cli(*SHORT, "--worst", "final_error_mm", "--json")
    assert code == 0
    assert json.loads(out)["evaluations"] >= 400
    assert (tmp_path / "boom" / "campaign-worst-final_error_mm.svg").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--replay", "10"), "is no run of this campaign of 10"),
        (("--worst", "beauty"), "is no figure"),
        (("--worst", "final_error_mm", "--replay", "1"), "one at a time"),
        (("--scheduler", "nonsense"), "--scheduler"),
        (("--gains", "no.toml"), "does not exist"),
    ],
)
def test_bad_input_ends_with_2(cli, arguments, message):
    code, _, err = cli(*TEN, *arguments)
    assert code == 2
    assert message in err


@pytest.mark.compiled
@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_ctrl_c_ends_with_130_keeps_chunks_and_resume_finishes(study_file, tmp_path, cli):
    code = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    code += "from mptune.cli.main import main; main()"
    arguments = (*SHORT, "--set", "campaign.runs=120", "--workers", "2")
    command = [sys.executable, "-c", code, "campaign", str(study_file), "--out", str(tmp_path)]
    process = subprocess.Popen(
        [*command, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    while len(list(tmp_path.rglob("chunk-*.nc"))) < 2:
        time.sleep(0.01)
        assert process.poll() is None
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: the workers get it as well
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert "--resume" in err
    assert "Traceback" not in err
    assert not out
    kept = len(list(tmp_path.rglob("chunk-*.nc")))
    assert 2 <= kept < 30
    alone = (*arguments, "--workers", "1")
    assert cli(*alone)[0] == 2
    assert cli(*alone, "--resume")[0] == 0


@pytest.mark.compiled
def test_gains_made_for_another_model_are_tried_and_what_differs_is_said(cli, load_boom, tmp_path):
    made_for = load_boom("load.force=5 kN")
    file = gains_of(made_for, judged_on=judged_on(made_for))
    gains = ("--gains", str(write_gains(tmp_path / "gains.toml", file)))
    three = ("--set", "campaign.runs=3")
    code, out, _ = cli(*SHORT, *three, *gains, "--json")
    values = json.loads(out)
    differs = {one["key"]: one["here"] for one in values["differs"]}
    assert code in {0, 1}
    assert values["runs"] == 3
    assert differs["load.force"] == "9700"
    assert "Made for another model" in cli(*SHORT, *three, *gains)[1]


def test_gains_of_another_controller_are_refused(cli, load_boom, tmp_path):
    other = load_boom("controller.position_filter=8 ms")
    file = gains_of(other, judged_on=judged_on(other))
    code, _, err = cli("--gains", str(write_gains(tmp_path / "gains.toml", file)))
    assert code == 2
    assert "controller.position_filter" in err
