"""Studies that are compared with another one: named by whoever wrote them, put on its load."""

from __future__ import annotations

import pytest

from mptune.errors import InputError
from mptune.job.beside import studies_beside
from mptune.params.beside import on_the_load_of
from mptune.params.load import load_study

BESIDE = '[systems]\nbeside = ["../boom/study.toml", "../long/study.toml"]\n'


@pytest.fixture
def write(root, tmp_path):
    """Write a study that is based on the boom, into a folder of its own."""

    def write(name, text=""):
        path = tmp_path / name / "study.toml"
        path.parent.mkdir()
        base = (root / "studies" / "boom" / "study.toml").as_posix()
        path.write_text(f'base = "{base}"\n{text}', encoding="utf-8")
        return path

    return write


def test_names_are_taken_from_the_folder_of_the_study_that_wrote_them(write):
    write("boom")
    write("long", '[cylinder]\nstroke = "500 mm"\n')
    found = studies_beside(load_study(write("other", BESIDE)))
    assert [one.name for one in found] == ["boom", "long"]
    assert found[1].study.cylinder.stroke == 0.5


def test_a_study_does_not_stand_beside_itself_nor_does_a_circle_close(write):
    """Its base puts both beside it; what stands beside another one is not followed."""
    write("boom", BESIDE)
    long = write("long")
    long.write_text('base = "../boom/study.toml"\n', encoding="utf-8")
    found = studies_beside(load_study(long))
    assert [one.name for one in found] == ["boom"]
    assert [one.name for one in studies_beside(found[0])] == ["long"]


def test_a_study_that_is_not_there_is_named_with_the_list(write):
    study = load_study(write("other", BESIDE))  # loads all the same
    with pytest.raises(InputError, match=r"systems\.beside.*boom.*cannot be taken"):
        studies_beside(study)


@pytest.mark.parametrize("value", ['"../boom/study.toml"', "[1]", '[""]', '["a\\u0000b"]'])
def test_what_names_no_files_is_refused(write, value):
    path = write("other", f"[systems]\nbeside = {value}\n")
    with pytest.raises(InputError, match=r"systems\.beside"):
        studies_beside(load_study(path))


def test_another_machine_keeps_its_own_valves_and_takes_load_and_moves(boom, study_file):
    changes = ['valves.delay=["4 ms", "5 ms"]', 'load.force="1 kN"', 'cylinder.bore="90 mm"']
    moved = on_the_load_of(boom, load_study(study_file, changes)).study
    assert moved.load == boom.study.load
    assert moved.verification.load_forces == boom.study.verification.load_forces
    assert moved.verification.delay_ranges() == ((4e-3, 5e-3),)
    assert moved.cylinder.bore == 0.09


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ('cylinder.stroke="200 mm"', "cylinder.stroke"),
        ('controller.pressure_max="2 MPa"', "load_forces"),
        ('controller.fast_sampling_period="10 us"', "manoeuvre"),
    ],
)
def test_what_cannot_make_the_moves_is_refused_before_it_runs(boom, study_file, change, key):
    few = 'manoeuvre=[{distance="5 mm", duration="1 s", rest="0 s"}]'
    light = ["load.force=0 N", "verification.start=50 mm", few, change]
    other = load_study(study_file, light)
    with pytest.raises(InputError, match=key):
        on_the_load_of(boom, other)
