"""``mptune export`` as users run it: files, JSON, exit statuses, and bad input one by one."""

import json
import shutil
import tomllib

import pytest
from target import any_compiler, gains_of

from mptune.cli.main import status
from mptune.params.gains import write_gains
from mptune.params.judged_on import judged_on

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

SHORT = 'uncertainty.delay=["11 ms", "14 ms"]'  # the loop then runs with a reserve
LONG = 'uncertainty.delay=["11 ms", "21.5 ms"]'  # Fig. 5's
CORNERS = ("--set", "uncertainty.points=2", "--set", SHORT)


@pytest.fixture
def gains(load_boom, tmp_path):
    """Write a gains file of the boom study, or of the study with overrides."""

    def write(*overrides, **changes):
        study = load_boom(SHORT, *overrides, corners=True)
        return write_gains(tmp_path / "gains.toml", gains_of(study, **changes))

    return write


@pytest.fixture
def export(study_file, tmp_path, capsys):
    """Run the command and return status, stdout, stderr and the folder of its files."""

    def run(gains, to, *arguments, study=study_file):
        line = ["export", str(gains), "--to", to, "--out", str(tmp_path / "out"), *CORNERS]
        line += ["--study", str(study)] if study else []
        code = status([*line, *arguments])
        captured = capsys.readouterr()
        return code, captured.out, captured.err, tmp_path / "out" / "boom"

    return run


@pytest.mark.parametrize(
    ("to", "files"),
    [
        ("toml", {"controller.toml"}),
        ("json", {"controller.json"}),
        ("st", {"controller.st"}),
        ("fmu", {"controller-fmi2.fmu", "controller-fmi3.fmu"}),
    ],
)
def test_each_format_is_written_and_named_in_json(export, gains, to, files):
    any_compiler()
    code, out, _, folder = export(gains(), to, "--json", "-q")
    values = json.loads(out)
    assert code == 0
    assert {path.name for path in folder.iterdir()} == files
    assert {path.rsplit("/", 1)[1] for path in values["files"]} == files
    assert values["satisfied"]
    assert values["broken_by_writing"] == []
    assert values["gains"]["k_p_vel"] == values["gains_swept"]["k_p_vel"] == 7e5
    assert {one["status"] for one in values["requirements"]} == {"satisfied"}


def test_c_is_a_folder_of_sources(export, gains):
    code, out, _, folder = export(gains(), "c", "--precision", "float")
    assert code == 0
    names = {path.name for path in (folder / "c").iterdir()}
    assert {"mptune_controller.h", "mptune_controller.c", "mptune_parameters.c"} <= names
    assert "#define MPTUNE_SINGLE_PRECISION 1" in (folder / "c" / "mptune_parameters.h").read_text()
    assert "Eq. 17" in out
    assert "wrote" in out


def test_gains_are_rounded_to_the_digits_asked_for(export, gains, tmp_path):
    given = gains("gains.tau=6.0463 ms", "gains.k_i_pos=22.456 1/s^2")
    changed = ("--set", "gains.tau=6.0463 ms")  # gains are no part of the study's hash
    code, _, _, folder = export(given, "toml", "--digits", "3", *changed)
    values = tomllib.loads((folder / "controller.toml").read_text(encoding="utf-8"))
    assert code == 0
    assert values["gains"]["tau"] == 0.00605
    assert values["gains"]["k_i_pos"] == 22.5


def test_rounding_that_breaks_a_requirement_writes_nothing(export, gains):
    limit = ("--set", "requirements.velocity_ratio=0.635", "--set", LONG)
    given = gains("requirements.velocity_ratio=0.635", "gains.k_p_vel=681 kN s/m", LONG)
    code, out, _, folder = export(given, "toml", "--digits", "1", *limit)
    assert code == 1
    assert not folder.exists()
    assert "Nothing was written" in out
    assert "velocity_ratio" in out
    code, out, _, _ = export(given, "toml", "--digits", "1", "--json", "-q", "--force", *limit)
    values = json.loads(out)
    assert (code, values["files"], values["satisfied"]) == (1, [], False)
    assert "velocity_ratio (Eq. 17)" in values["broken_by_writing"]


def test_gains_without_satisfied_margins_need_force(export, gains):
    given = gains(margins="violated")
    code, _, err, folder = export(given, "toml")
    assert code == 2
    assert "margins" in err
    assert "--force" in err
    assert not folder.exists()
    code, out, _, folder = export(given, "toml", "--force")
    assert code == 1
    assert "NOT satisfied" in " ".join(out.split())
    assert "NOT satisfied" in (folder / "controller.toml").read_text(encoding="utf-8")


def test_gains_whose_margins_fail_when_swept_need_force_whatever_the_file_says(export, gains):
    limit = ("--set", "requirements.velocity_ratio=0.6", "--set", LONG)
    given = gains("requirements.velocity_ratio=0.6", LONG)
    code, _, err, folder = export(given, "toml", *limit)
    assert code == 2
    assert "violated" in err
    assert not folder.exists()
    assert export(given, "toml", "--force", *limit)[0] == 1


def test_gains_of_another_model_are_judged_on_this_one_and_every_file_says_so(
    export, gains, load_boom
):
    early = gains("load.force=5 kN")
    assert export(early, "toml")[0] == 2  # it does not say what it was made for
    elsewhere = judged_on(load_boom(SHORT, "load.force=5 kN", corners=True))
    code, out, _, folder = export(gains("load.force=5 kN", judged_on=elsewhere), "toml")
    said = {"key": "load.force", "made_for": "5000", "here": "9700"}
    values = tomllib.loads((folder / "controller.toml").read_text(encoding="utf-8"))
    assert code == 0
    assert "Made for another model" in out
    assert values["verdict"]["differs"] == [said]
    code, out, _, _ = export(gains(judged_on=elsewhere, study_hash="b" * 64), "st", "--json", "-q")
    assert json.loads(out)["differs"] == [said]
    assert "load.force: 5000 in the gains file" in (folder / "controller.st").read_text()


def test_gains_of_another_controller_are_refused(export, gains, load_boom):
    other = load_boom("controller.position_filter=8 ms")
    given = gains(judged_on=judged_on(other), study_hash=other.hash())
    code, _, err, _ = export(given, "toml")
    assert code == 2
    assert "controller.position_filter" in err


def test_the_uncertainty_set_is_the_gains_own(export, load_boom, tmp_path):
    study = load_boom(uncertainty="section-5-1", corners=True)
    given = write_gains(tmp_path / "gains.toml", gains_of(study))
    points = ("--set", "uncertainty.points=7", "--set", "uncertainty.sets.section-5-1.points=2")
    code, out, _, _ = export(given, "toml", "--json", "-q", *points)
    assert code == 0
    values = json.loads(out)
    assert values["uncertainty"] == "section-5-1"
    found = {one["requirement"]: one["found"] for one in values["requirements"]}
    assert found["velocity_ratio (Eq. 17)"] == pytest.approx(0.509, abs=1e-3)


@pytest.mark.parametrize("where", ["beside", "studies", "above"])
def test_the_study_is_found_beside_or_above(
    export, gains, study_file, tmp_path, monkeypatch, where
):
    (tmp_path / "away").mkdir()
    monkeypatch.chdir(tmp_path / "away")
    given = gains()
    places = {
        "beside": tmp_path / "study.toml",
        "studies": tmp_path / "studies" / "boom" / "study.toml",
        "above": tmp_path / "away" / "studies" / "boom" / "study.toml",
    }
    places[where].parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(study_file, places[where])
    code, out, _, _ = export(given, "st", "--json", "-q", study=None)
    assert code == 0
    assert len(json.loads(out)["files"]) == 1


def test_a_study_that_is_nowhere_is_asked_for(export, gains, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, _, err, _ = export(gains(), "toml", study=None)
    assert code == 2
    assert "'boom'" in err
    assert "--study" in err


@pytest.mark.parametrize(
    "arguments", [("--digits", "0"), ("--digits", "18"), ("--precision", "half")]
)
def test_bad_options_are_refused(export, gains, arguments):
    assert export(gains(), "toml", *arguments)[0] == 2


def test_a_format_unknown_or_missing_is_refused(export, gains, capsys):
    given = gains()
    assert export(given, "matlab")[0] == 2
    assert status(["export", str(given)]) == 2


def test_what_is_no_gains_file_is_refused(export, tmp_path, study_file):
    assert export(study_file, "toml")[0] == 2
    code, _, err, _ = export(tmp_path / "nothing.toml", "toml")
    assert code == 2
    assert "does not exist" in err


def test_a_folder_that_cannot_be_written_is_said(export, gains, tmp_path):
    (tmp_path / "out").write_text("in the way")
    assert export(gains(), "toml")[0] == 2


def test_a_number_beyond_single_precision_is_refused(export, gains):
    weight = "controller.weight_converter=1e39 N s/m^6"
    code, _, err, folder = export(gains(weight), "c", "--precision", "float", "--set", weight)
    assert code == 2
    assert "weight_converter" in err
    assert not folder.exists()
