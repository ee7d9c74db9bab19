"""``mptune compare``: one table and figure, and clear words where models do not match."""

import json

import pytest

from mptune.cli.main import status

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

CORNERS = ("--set", "uncertainty.points=2")
SHORT = 'uncertainty.delay=["11 ms", "14 ms"]'  # the loop then runs with a reserve


@pytest.fixture
def cli(tmp_path, capsys):
    def run(*arguments):
        code = status([*map(str, arguments), "--out", str(tmp_path / "out"), *CORNERS])
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run


@pytest.fixture
def gains(study_file, tmp_path, load_boom):
    """Write gains files of the study's own gains, and of a lower velocity gain."""
    from mptune.job.gains import gains_file
    from mptune.params.gains import write_gains
    from mptune.robust.sweep import sweep

    def write(name, *overrides):
        study = load_boom(*overrides, corners=True)
        file = gains_file(sweep(study), study.study.feedforward, (), None)
        return write_gains(tmp_path / f"{name}.toml", file)

    return write


def test_two_gains_files_and_their_study_in_one_table(cli, gains, study_file, tmp_path):
    low = gains("low", "gains.k_p_vel=500 kN s/m")
    code, out, _ = cli("compare", study_file, low)
    said = [line for line in out.splitlines() if line.startswith(("boom, study's own: ", "low: "))]
    assert code == (0 if all(": met: " in line for line in said) else 1)
    assert len(said) == 2
    assert "700 kN s/m" in out
    assert "500 kN s/m" in out
    assert "low" in out
    assert (tmp_path / "out" / "compare.svg").read_text().lstrip().startswith("<?xml")


def test_json_holds_each_entry_in_order_and_agrees_with_sweep(cli, gains, study_file):
    low, own = gains("low", "gains.k_p_vel=500 kN s/m"), gains("own")
    code, out, _ = cli("compare", own, low, "--study", study_file, "--json")
    entries = json.loads(out)["compared"]
    assert code == (0 if {one["verdict"] for one in entries} == {"met"} else 1)
    assert [one["gains"]["k_p_vel"] for one in entries] == [7e5, 5e5]
    assert entries[0]["sweep"]["velocity"]["worst_ratio"] == pytest.approx(0.641, abs=5e-4)
    _, out, _ = cli("sweep", study_file, "--gains", low, "--json")
    alone = json.loads(out)
    assert entries[1]["sweep"]["velocity"] == alone["velocity"]
    assert (
        entries[0]["linear_check_index_ms"]["24500_kg"]
        < entries[0]["linear_check_index_ms"]["49000_kg"]
    )


def test_gains_of_another_model_are_judged_and_what_differs_is_said(cli, gains, study_file):
    other = gains("other", "load.force=5 kN")
    _, out, _ = cli("compare", gains("own"), other, "--study", study_file, "--json")
    own, moved = json.loads(out)["compared"]
    assert own["differs"] == []
    assert [one["key"] for one in moved["differs"]] == ["load.force"]
    assert moved["study_hash"] == own["study_hash"]
    _, out, _ = cli("compare", gains("own"), other, study_file)
    assert "other: made for another model" in out


def test_a_finer_grid_and_another_set_judge_exported_gains(study_file, gains, tmp_path, capsys):
    arguments = ["compare", str(study_file), str(gains("own", SHORT)), "--out", str(tmp_path)]
    finer = ["--uncertainty", "section-5-1", "--set", "uncertainty.sets.section-5-1.points=3"]
    code = status([*arguments, *finer, "--json"])
    entries = json.loads(capsys.readouterr().out)["compared"]
    assert code == 0
    assert [one["verdict"] for one in entries] == ["met", "met"]
    assert {one["key"] for one in entries[1]["differs"]} >= {
        "uncertainty.points",
        "uncertainty.delay",
    }


def test_a_controller_of_other_filters_is_refused(cli, gains, study_file):
    other = gains("other", "controller.position_filter=8 ms")
    code, out, err = cli("compare", gains("own"), other, "--study", study_file)
    assert (code, out) == (2, "")
    assert "other.toml" in err
    assert "controller.position_filter" in err


def test_gains_alone_need_their_study(cli, gains):
    code, _, err = cli("compare", gains("one"), gains("two"))
    assert code == 2
    assert "--study" in err


def test_a_study_s_own_gains_are_judged_on_the_model_of_study(cli, gains, study_file, tmp_path):
    other = tmp_path / "other.toml"
    lines = (f'base = "{study_file}"', "[gains]", "xi = 0.7", "[load]", 'force = "5 kN"')
    other.write_text("\n".join(lines), encoding="utf-8")
    _, out, _ = cli("compare", gains("own"), other, "--study", study_file, "--json")
    own, moved = json.loads(out)["compared"]
    assert moved["study_hash"] == own["study_hash"]
    assert moved["gains"]["xi"] == 0.7
    assert [one["key"] for one in moved["differs"]] == ["load.force"]


def test_a_study_of_another_controller_is_refused_beside_study(cli, gains, study_file, root):
    other = root / "studies" / "boom-2dof" / "study.toml"
    code, _, err = cli("compare", gains("own"), other, "--study", study_file)
    assert code == 2
    assert "controller." in err
    assert "another controller" in err


def test_a_missing_file_may_be_gains_or_a_study(cli, study_file, tmp_path):
    code, _, err = cli("compare", study_file, tmp_path / "gone.toml")
    assert code == 2
    assert "`mptune tune STUDY` writes gains" in err


@pytest.mark.parametrize("count", [0, 1])
def test_fewer_than_two_are_bad_usage(cli, study_file, count):
    assert cli("compare", *([study_file] * count))[0] == 2


def test_an_edited_gains_file_is_refused(cli, gains, study_file):
    path = gains("edited")
    path.write_text(path.read_text().replace("700000.0", "900000.0"))
    code, _, err = cli("compare", path, study_file)
    assert code == 2
    assert "edited" in err


def test_equal_names_are_told_apart(cli, gains, study_file):
    code, out, _ = cli("compare", study_file, study_file, "--json")
    labels = [one["label"] for one in json.loads(out)["compared"]]
    assert code in {0, 1}
    assert len(set(labels)) == 2
