"""The commands as users run them: words, JSON, exit statuses, and bad input one by one."""

import json
import re

import pytest

from mptune.cli.main import status
from mptune.job.gains import gains_file
from mptune.params.gains import read_gains, write_gains
from mptune.params.headline import Headline
from mptune.params.load import load_study
from mptune.robust.sweep import sweep

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

CORNERS = ("--set", "uncertainty.points=2")
SHORT = ("--set", 'uncertainty.delay=["11 ms", "14 ms"]')  # the loop then runs with a reserve
BRIEF = (
    *CORNERS,
    *("--set", "verification.repeats=2"),
    *("--set", "verification.seeds=[1]"),
    *("--set", 'verification.oil_bulk_moduli=["1200 MPa"]'),
)


def test_sweep_json_holds_the_agreed_keys(cli):
    code, out, _ = cli("sweep", "--json", *CORNERS)
    values = json.loads(out)
    assert code == (0 if values["verdict"] == "met" else 1)
    for name in ("velocity", "position"):
        assert {"worst_ratio", "margin", "satisfied", "nominal_stable", "at"} <= set(values[name])
        at = values[name]["at"]
        assert set(at) == {"mass_kg", "delay_s", "tau_a_s", "tau_b_s", "frequency_rad_s"}
    assert values["velocity"]["worst_ratio"] == pytest.approx(0.641, abs=5e-4)
    assert values["position"]["worst_ratio"] == pytest.approx(0.476, abs=5e-4)
    assert values["velocity"]["at"]["mass_kg"] == 24500


def test_json_stands_alone_on_stdout_and_is_strict(cli):
    _, out, _ = cli("sweep", "--json", *CORNERS)

    def refuse(token):
        raise AssertionError(token)

    json.loads(out, parse_constant=refuse)
    assert out.count("\n") == 1


def test_uncertainty_set_is_chosen_by_name(cli):
    extra = ("--set", "uncertainty.sets.section-5-1.points=2")
    code, out, _ = cli("sweep", "--json", "--uncertainty", "section-5-1", *extra)
    assert (code, json.loads(out)["verdict"]) == (0, "met")
    assert json.loads(out)["velocity"]["worst_ratio"] == pytest.approx(0.509, abs=5e-4)


def test_a_violated_requirement_ends_with_status_1(cli):
    code, out, _ = cli("sweep", *CORNERS, "--set", "requirements.position_ratio=0.4")
    assert code == 1
    assert "violated" in out


def test_tables_show_units_and_verdict(cli):
    code, out, _ = cli("sweep", *CORNERS, *SHORT)
    assert code == 0
    assert out.startswith("Verdict: met: every requirement; the gain at F_ref may rise by 1.2")
    assert "delay margin [ms]" in out
    assert "satisfied" in out
    assert "rad/s" in out


def test_tune_writes_gains_that_sweep_accepts(cli, tmp_path):
    code, out, _ = cli("tune", "--json", *CORNERS)
    values = json.loads(out)
    assert code == (0 if values["verdict"] == "met" else 1)
    assert set(values["gains"]) == {"k_p_vel", "k_p_pos", "k_i_pos", "omega", "xi", "tau"}
    before, after = values["objective"]["before"], values["objective"]["after"]
    assert after["tracking_index_s"] < before["tracking_index_s"]
    gains = tmp_path / "out" / "boom" / "gains.toml"
    again, out, _ = cli("sweep", "--json", "--gains", str(gains), *CORNERS)
    assert again == code
    assert json.loads(out)["verdict"] == values["verdict"]
    assert json.loads(out)["position"]["worst_ratio"] == pytest.approx(
        values["position_worst_ratio"], rel=1e-9
    )


def test_gains_are_judged_on_another_model_of_the_same_controller(cli, tmp_path):
    cli("tune", "--json", *CORNERS)
    gains = ("--gains", str(tmp_path / "out" / "boom" / "gains.toml"))
    _, out, _ = cli("sweep", *gains, *SHORT, "--set", "uncertainty.points=3", "--json")
    differs = {one["key"]: one for one in json.loads(out)["differs"]}
    assert set(differs) == {"uncertainty.delay", "uncertainty.points"}
    assert (differs["uncertainty.points"]["made_for"], differs["uncertainty.points"]["here"]) == (
        "2",
        "3",
    )
    _, out, _ = cli("sweep", *gains, *CORNERS, "--set", "load.force=5 kN")
    assert "Made for another model" in out
    assert "load.force" in out


def test_gains_of_another_controller_are_refused(cli, tmp_path):
    cli("tune", "--json", *CORNERS)
    gains = ("--gains", str(tmp_path / "out" / "boom" / "gains.toml"))
    code, _, err = cli("sweep", *gains, *CORNERS, "--set", "controller.position_filter=8 ms")
    assert code == 2
    assert "controller.position_filter" in err
    assert "another controller" in err


def test_infeasible_tuning_ends_with_status_1_and_names_the_blocking_point(cli):
    code, out, _ = cli("tune", *CORNERS, "--set", "requirements.velocity_ratio=0.45")
    assert code == 1
    assert "infeasible" in out
    assert "velocity_ratio" in out
    assert "0.5" in out


def test_run_does_the_whole_job(cli, tmp_path):
    (tmp_path / "out/boom").mkdir(parents=True)
    left = tmp_path / "out/boom/front.json"
    left.write_text("spoilt")
    code, out, _ = cli("run", *BRIEF)
    left.unlink()
    assert code == (0 if out.startswith("Verdict: met: ") else 1)
    written = {path.name for path in (tmp_path / "out").rglob("*") if path.is_file()}
    assert written == {
        "boom.pdf", "boom.png", "sweep.nc", "gains.toml", "panels.svg", "bode.svg", "moves.svg",
        "traces.nc", "machine-24.5t.svg", "machine-49t.svg", "chain.svg", "boom.html",
        "nyquist.svg", "sensitivity.svg", "load.svg", "certificates.svg",
    }  # fmt: skip
    words = " ".join(out.split())
    assert "nonlinear machine" in words[words.index("Gain at F_ref may rise by") :]
    assert words.startswith("Verdict: met")
    assert "On the machine the tuned gains are" in words
    assert "front.json was left out, for it is not JSON." in words
    assert "the paper's own frame alone: linear tracking index 14.4" in words
    assert len(out.splitlines()) <= 40
    assert "\x1b" not in out  # no terminal: no colour


def test_verify_json_holds_the_agreed_keys(cli):
    code, out, _ = cli("verify", "--json", *BRIEF, *SHORT)
    values = json.loads(out)
    assert (code, values["verdict"]) == (0, "met")
    assert values["chain"][-1]["model"] == "nonlinear machine"
    assert len(values["cases"]) == 2
    for case in values["cases"]:
        assert {
            "mass_kg", "valve_delay_s", "oil_bulk_modulus_pa", "stable", "performance_index_ms",
            "energy_loss_j_per_mm", "force_error_integral_kn2s", "final_error_mm",
            "valve_switches", "converter_peak_mm",
        } <= set(case)  # fmt: skip


def test_verify_of_gains_writes_its_verdict_into_a_copy(cli, study_file, tmp_path):
    study = load_study(study_file, [BRIEF[1], SHORT[1]])
    own = gains_file(sweep(study), study.study.feedforward, (), None)
    given = write_gains(tmp_path / "given.toml", own)
    code, out, _ = cli("verify", "--gains", str(given), *BRIEF, *SHORT, "--set", "load.force=5 kN")
    copy = read_gains(tmp_path / "out" / "boom" / "gains-verified.toml")
    assert code == 0
    assert "load.force" in out
    assert (own.closed_loop, copy.closed_loop) == ("not run", "satisfied")
    assert (copy.verdict, copy.margins) == (Headline.MET, "satisfied")
    assert copy.study_hash != own.study_hash
    assert copy.gains == own.gains
    assert read_gains(given) == own


def test_verify_of_a_limit_cycle_ends_with_status_1_and_says_so(cli):
    code, out, _ = cli("verify", *BRIEF, "--set", "gains.k_p_vel=1400 kN s/m")
    assert code == 1
    assert "limit cycle" in out


def test_gains_with_violated_margins_are_refused_unless_forced(cli, tmp_path):
    tight = ("--set", "requirements.velocity_ratio=0.45")
    assert cli("tune", *BRIEF, *tight)[0] == 1
    gains = str(tmp_path / "out" / "boom" / "gains.toml")
    code, _, err = cli("verify", "--gains", gains, *BRIEF, *tight)
    assert code == 2
    assert "--force" in err
    code, out, _ = cli("verify", "--gains", gains, "--force", *BRIEF, *tight)
    assert code == 1
    assert out.startswith("Verdict: not met: velocity_ratio")


def test_new_study_runs_as_it_stands_and_is_not_overwritten(cli, tmp_path, capsys):
    assert status(["new", "crane", "--in", str(tmp_path)]) == 0
    study = tmp_path / "crane" / "study.toml"
    code, out, err = cli("sweep", *CORNERS, study=study)
    assert code in {0, 1}, err
    assert "Eq. 17" in out
    assert status(["new", "crane", "--in", str(tmp_path)]) == 2
    assert "exists already" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["../up", "a/b", "", ".hidden"])
def test_new_refuses_a_name_that_is_no_folder_name(name, tmp_path, capsys):
    assert status(["new", name, "--in", str(tmp_path)]) == 2
    assert list(tmp_path.iterdir()) == []
    assert "mptune:" in capsys.readouterr().err


def test_ledger_is_printed(capsys):
    assert status(["ledger"]) == 0
    out = " ".join(capsys.readouterr().out.split())
    assert "Eq. 11" in out
    assert "12.2" in out


def test_help_lists_the_commands(capsys):
    assert status(["--help"]) == 0
    out = capsys.readouterr().out
    for command in ("run", "sweep", "tune", "verify", "new", "ledger"):
        assert re.search(rf"^\s+{command}\s", out, re.MULTILINE)
