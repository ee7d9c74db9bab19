"""Study files as files: missing, empty, cut, spoilt, and what a study is called after them."""

from __future__ import annotations

from refusals import faults_of, refused

from mptune.params.load import load_study


def test_a_missing_file_is_an_input_error(tmp_path):
    refused(tmp_path / "study.toml", "", "does not exist", "start a study with `mptune new NAME`")


def test_a_folder_is_an_input_error(tmp_path):
    refused(tmp_path, "", "folder", "file inside")


def test_an_empty_file_is_an_input_error(tmp_path):
    path = tmp_path / "study.toml"
    path.touch()
    refused(path, "", "empty")


def test_a_file_that_is_not_utf_8_is_an_input_error(tmp_path, study_file):
    path = tmp_path / "study.toml"
    path.write_bytes(study_file.read_text(encoding="utf-8").encode("latin-1", "replace") + b"\xe9")
    refused(path, "", "UTF-8", "UTF-8")


def test_a_file_cut_within_a_line_is_an_input_error(tmp_path, study_file):
    text = study_file.read_text(encoding="utf-8")
    path = tmp_path / "study.toml"
    path.write_text(text[: text.index("dead_volume_a") + 20], encoding="utf-8")
    refused(path, "", "not valid TOML", "line")


def test_a_file_cut_between_lines_misses_its_sections(tmp_path, study_file):
    text = study_file.read_text(encoding="utf-8")
    path = tmp_path / "study.toml"
    path.write_text(text[: text.index("[uncertainty]")], encoding="utf-8")
    missing = {fault.key for fault in faults_of(path) if "missing" in fault.rule}
    assert {"uncertainty", "gains", "manoeuvre", "verification"} <= missing


def test_a_key_given_twice_is_an_input_error(tmp_path, study_file):
    path = tmp_path / "study.toml"
    text = study_file.read_text(encoding="utf-8")
    path.write_text(text.replace('rod = "40 mm"', 'rod = "40 mm"\nrod = "45 mm"'))
    refused(path, "", "not valid TOML")


def test_deeply_nested_brackets_are_an_input_error(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text("x = " + "[" * 100_000)
    refused(path, "", "TOML")


def test_windows_line_ends_do_no_harm(tmp_path, study_file, boom):
    path = tmp_path / "study.toml"
    path.write_bytes(study_file.read_bytes().replace(b"\n", b"\r\n"))
    assert load_study(path).hash() == boom.hash()


def test_the_name_of_a_study_is_its_folder_or_else_its_file(tmp_path, study_file):
    crane = tmp_path / "crane.toml"
    crane.write_bytes(study_file.read_bytes())
    assert load_study(crane).name == "crane"
    assert load_study(str(study_file)).name == "boom"
