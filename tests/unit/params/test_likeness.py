"""A study like another: whole, of the same model, with its files beside it."""

import shutil

import pytest

from mptune.cli.main import status
from mptune.errors import InputError
from mptune.params.bundled import bundled_studies, named_study
from mptune.params.load import load_study
from mptune.params.template import write_template

BUNDLED = bundled_studies()
RECORDED = "time [s],position [mm]\n0,0\n0.5,10\n1,30\n1.5,40\n"
TABLE = "position [mm],force [kN],inertia [-]\n0,0,1\n300,1,1\n"
MEASURED = "frequency [Hz],real [-],imaginary [-]\n1,1,-0.1\n2,1,-0.2\n4,0.9,-0.3\n8,0.8,-0.5\n"
OF_FILES = """
base = "../boom/study.toml"
[[manoeuvre]]
kind = "file"
file = "../data/move.csv"
rest = "1 s"
[load]
table = "table.csv"
[uncertainty]
measured = ["rig.csv"]
[uncertainty.sets.other]
mass = ["20 t", "30 t"]
delay = "derived"
tau_a = "derived"
tau_b = "derived"
measured = ["../data/rig.csv"]
"""


@pytest.fixture
def of_files(tmp_path):
    """Write a study on a base that names files of both folders, two of them of one name."""
    here, data = tmp_path / "rig", tmp_path / "data"
    here.mkdir()
    data.mkdir()
    (tmp_path / "boom").mkdir()
    shutil.copy(BUNDLED["boom"], tmp_path / "boom")
    (here / "study.toml").write_text(OF_FILES)
    (here / "table.csv").write_text(TABLE)
    (data / "move.csv").write_text(RECORDED)
    (here / "rig.csv").write_text(MEASURED)
    (data / "rig.csv").write_text(MEASURED.replace("0.8,-0.5", "0.7,-0.5"))
    return here / "study.toml"


@pytest.mark.parametrize("name", [*BUNDLED])
def test_a_study_like_a_bundled_one_is_the_same_model_without_a_base(tmp_path, name):
    path = write_template(tmp_path, "mine", name)
    text = path.read_text(encoding="utf-8")
    one, other = load_study(path), load_study(BUNDLED[name])
    assert "\nbase = " not in text
    assert one.name == one.title == "mine"
    assert one.hash() == other.hash()
    for section in ("gains", "feedforward", "estimator", "verification", "sources", "supplies"):
        assert getattr(one.study, section) == getattr(other.study, section), section
    assert [*one.study.uncertainty.sets] == [*other.study.uncertainty.sets]
    assert one.doubts == other.doubts


def test_each_section_s_first_mention_of_a_key_explains_it(tmp_path):
    text = write_template(tmp_path, "mine", "boom").read_text(encoding="utf-8")
    assert 'bore = "80 mm" # D, bore diameter' in text
    assert 'mass = ["24500 kg", "49000 kg"] # m, effective inertia' in text
    assert 'rated_flow = "40 l/min" # ' in text  # of a section within a section
    assert text.count("# A, signed length of the move") == 1


def test_what_it_was_compared_with_stays_behind(tmp_path):
    assert load_study(BUNDLED["boom"]).study.systems.beside
    assert not load_study(write_template(tmp_path, "mine", "boom")).study.systems.beside


def test_files_come_along_under_names_of_their_own(tmp_path, of_files):
    path = write_template(tmp_path / "new", "mine", str(of_files))
    files = {one.name for one in path.parent.iterdir()}
    assert files == {"study.toml", "move.csv", "table.csv", "rig.csv", "rig-2.csv"}
    shutil.rmtree(of_files.parent)
    shutil.rmtree(tmp_path / "data")
    one = load_study(path, uncertainty="other")
    assert one.uncertainty.measured[0].rows[-1][1] == 0.7
    assert load_study(path).uncertainty.measured[0].rows[-1][1] == 0.8
    assert one.study.load.table[1][1] == 1e3


def test_a_copy_of_a_copy_is_the_same_text(tmp_path, of_files):
    first = write_template(tmp_path / "a", "mine", str(of_files.parent))
    second = write_template(tmp_path / "b", "mine", str(first))
    assert first.read_text(encoding="utf-8") == second.read_text(encoding="utf-8")


def test_nothing_is_written_over_a_file(tmp_path, of_files):
    there = tmp_path / "new" / "mine" / "move.csv"
    there.parent.mkdir(parents=True)
    there.write_text("mine")
    with pytest.raises(InputError, match="exists already"):
        write_template(tmp_path / "new", "mine", str(of_files))
    assert there.read_text() == "mine"
    assert [one.name for one in there.parent.iterdir()] == ["move.csv"]


def test_what_cannot_be_loaded_is_not_copied(tmp_path, of_files):
    of_files.write_text(OF_FILES + "\n[oil]\nbulk_modulus = 3\n")
    with pytest.raises(InputError, match=r"oil\.bulk_modulus"):
        write_template(tmp_path / "new", "mine", str(of_files))
    assert not (tmp_path / "new").exists()


def test_a_name_that_is_no_study_is_told_which_there_are():
    with pytest.raises(InputError, match=r"neither a bundled study nor a study's file.*crane"):
        named_study("cranes")
    assert {"boom", "crane", "fast"} <= BUNDLED.keys()


def test_the_command_takes_a_name_or_a_path(tmp_path, capsys, of_files):
    for like in ("fast", str(of_files)):
        folder = str(tmp_path / like.strip("/").replace("/", "-"))
        assert status(["new", "mine", "--like", like, "--in", folder, "-q"]) == 0
    assert status(["new", "mine", "--like", "none", "--in", str(tmp_path)]) == 2
    assert "--like" in capsys.readouterr().err
