"""File names inside a study are taken from the folder of the file that wrote them."""

from __future__ import annotations

import pytest

from mptune.errors import InputError
from mptune.params.load import load_study

MOVE = '[[manoeuvre]]\nkind = "file"\nfile = "move.csv"\nrest = "1 s"\n'
RECORDED = "time [s],position [mm]\n" + "".join(f"{n},{n}\n" for n in range(5))
MEASURED = "frequency [Hz],re,im\n" + "".join(f"{n},0.5,-0.{n}\n" for n in range(1, 6))


def without_moves(text):
    return text[: text.index("[[manoeuvre]]")] + text[text.index("[verification]") :]


@pytest.fixture
def files_in_base(write, study_file):
    text = without_moves(study_file.read_text(encoding="utf-8"))
    text = text.replace("[load]", '[load]\ntable = "table.csv"')
    text = text.replace("\npoints = 7\n", '\npoints = 7\nmeasured = ["rigs/rig.csv"]\n')
    write("base/study.toml", text.replace("[verification]", MOVE + "[verification]"))
    write("base/move.csv", RECORDED)
    write("base/table.csv", "position [mm],force [kN],inertia [-]\n0,1,1\n300,2,1\n")
    write("base/rigs/rig.csv", MEASURED)


@pytest.mark.usefixtures("files_in_base")
def test_files_that_a_base_names_stand_beside_the_base(write):
    study = load_study(write("crane/study.toml", 'base = "../base/study.toml"\n'))
    assert study.study.manoeuvre[0].samples[1] == (1.0, 0.001)
    assert study.study.load.table == ((0.0, 1000.0, 1.0), (0.3, 2000.0, 1.0))
    assert study.uncertainty.measured[0].name == "rig"


@pytest.mark.usefixtures("files_in_base")
def test_files_that_a_study_names_stand_beside_the_study(write):
    own = MOVE + '[load]\ntable = "table.csv"\n[uncertainty]\nmeasured = ["own.csv"]\n'
    path = write("crane/study.toml", 'base = "../base/study.toml"\n' + own)
    write("crane/move.csv", RECORDED.replace("mm", "cm"))
    write("crane/table.csv", "position [mm],force [kN],inertia [-]\n0,3,1\n300,4,1\n")
    write("crane/own.csv", MEASURED)
    study = load_study(path)
    assert study.study.manoeuvre[0].samples[1] == (1.0, 0.01)
    assert study.study.load.table[0] == (0.0, 3000.0, 1.0)
    assert study.uncertainty.measured[0].name == "own"


@pytest.mark.usefixtures("files_in_base")
def test_files_that_the_command_line_names_stand_beside_the_study(write):
    path = write("crane/study.toml", 'base = "../base/study.toml"\n')
    write("crane/other.csv", MEASURED)
    study = load_study(path, ['uncertainty.measured=["other.csv"]'])
    assert study.uncertainty.measured[0].name == "other"


@pytest.mark.usefixtures("files_in_base")
def test_a_file_that_the_study_does_without_is_not_read(write, tmp_path):
    (tmp_path / "base" / "rigs" / "rig.csv").unlink()
    path = write("crane/study.toml", 'base = "../base/study.toml"\n')
    with pytest.raises(InputError, match=r"base/rigs/rig\.csv: does not exist"):
        load_study(path)
    over = "[uncertainty]\nmeasured = []\n"
    assert not load_study(
        write("crane/study.toml", f'base = "../base/study.toml"\n{over}')
    ).uncertainty.measured


@pytest.mark.usefixtures("files_in_base")
def test_a_set_of_the_base_names_files_beside_the_base(write, tmp_path):
    text = (tmp_path / "base" / "study.toml").read_text(encoding="utf-8")
    named = '[uncertainty.sets.section-5-1]\nmeasured = ["rigs/rig.csv"]'
    write("base/study.toml", text.replace("[uncertainty.sets.section-5-1]", named))
    path = write("crane/study.toml", 'base = "../base/study.toml"\n')
    assert load_study(path, uncertainty="section-5-1").uncertainty.measured[0].name == "rig"
