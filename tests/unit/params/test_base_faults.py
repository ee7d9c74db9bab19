"""Studies with a base: who is named when something is wrong, and bases that cannot be."""

from __future__ import annotations

import pytest

from mptune.errors import InputError
from mptune.params.load import load_study


def faults_of(path, overrides=()):
    with pytest.raises(InputError) as caught:
        load_study(path, overrides)
    return caught.value


@pytest.mark.parametrize("where", ["base", "crane"])
def test_a_source_that_says_nothing_names_its_file(child, tmp_path, where):
    bad = 'hose = "somebody told me"'
    if where == "base":
        path = child('[sources]\noil = "measured: here"\n', ('hose = "published: Table 1"', bad))
    else:
        path = child(f"[sources]\n{bad}\n")
    error = faults_of(path)
    assert error.where == str(tmp_path / where / "study.toml")
    assert error.faults[0].key == "sources.hose"


def test_sources_that_are_no_texts_are_refused_in_words(child):
    error = faults_of(child("", ("[sources]", "[sources]\ngains.xi = 'derived: so'")))
    assert "sources" in str(error)
    error = faults_of(child("[sources]\ncylinder.bore = 'derived: so'\n"))
    assert "`sources.cylinder`" in str(error)
    assert "`sources`" in str(faults_of(child("sources = 1\n")))


# Errors name the file that a value came from.


@pytest.mark.parametrize(
    ("text", "replaced", "where", "key"),
    [
        ("", ('bore = "80 mm"', 'bore = "80 MPa"'), "base", "cylinder.bore"),
        ("", ('bore = "80 mm"', 'boer = "80 mm"\nbore = "80 mm"'), "base", "cylinder.boer"),
        ("", ("[hose]", "[hoze]\nx = 1\n[hose]"), "base", "hoze"),
        ("", ('rest = "1 s"', 'rest = "1 m"'), "base", "manoeuvre[1].rest"),
        ("", ('rod = "40 mm"', 'rod = "90 mm"'), "base", "cylinder"),
        ("", ("points = 7\n", "points = 7.5\n"), "base", "uncertainty.points"),
        (  # the longer key is another one's
            '[oil]\nbulk_modulus_estimate = "1500 MPa"\n',
            ('bulk_modulus = ["800 MPa"', 'bulk_modulus = ["800 mm"'),
            "base",
            "oil.bulk_modulus",
        ),
        ('[cylinder]\nbore = "80 MPa"\n', ("#", "#"), "crane", "cylinder.bore"),
        ('[cylinder]\nbore = "30 mm"\n', ("#", "#"), "crane", "cylinder"),
        ("cylinder = 4\n", ("#", "#"), "crane", "cylinder"),
        ("[oil]\nbulk_moduluss = 1\n", ("#", "#"), "crane", "oil.bulk_moduluss"),
        ("", ('rod = "40 mm"\n', ""), "crane", "cylinder.rod"),  # missing: write it in either
    ],
)
def test_an_error_names_the_file_that_wrote_the_value(child, tmp_path, text, replaced, where, key):
    error = faults_of(child(text, replaced))
    path = tmp_path / where / "study.toml"
    assert error.where == str(path)
    assert error.faults[0].key == key
    assert str(error).startswith(f"{path}: `{key}`")


def test_faults_of_several_files_and_of_the_command_line_come_at_once(child, tmp_path):
    path = child("[gains]\nxi = -1\n", ('bore = "80 mm"', 'bore = "80 s"'))
    lines = str(faults_of(path, ["load.force=5 kg"])).splitlines()
    assert len(lines) == 3
    assert lines[0].startswith(f"{tmp_path / 'base' / 'study.toml'}: `cylinder.bore`")
    assert lines[1].startswith("--set: `load.force`")
    assert lines[2].startswith(f"{path}: `gains.xi`")


def test_what_a_replaced_table_held_is_missing_from_the_study_and_not_from_its_base(child):
    path = child()
    error = faults_of(path, ['load={force="5 kN"}'])
    assert error.where == str(path)
    assert "load.friction_coulomb" in {fault.key for fault in error.faults}


def test_a_value_that_the_study_mends_is_no_fault_of_its_base(child):
    path = child('[cylinder]\nbore = "80 mm"\n', ('bore = "80 mm"', 'bore = "80 MPa"'))
    assert load_study(path).study.cylinder.bore == 0.08


def test_a_rule_over_sections_names_the_file_of_its_key(child, tmp_path):
    loop = ('kind = "tracking"', 'kind = "tracking"\ntracking_loop = "sampled"')
    path = child('[uncertainty]\ndelay_as_it_runs = ["1 ms", "2 ms"]\n', loop)
    assert faults_of(path).where == str(tmp_path / "base" / "study.toml")


def test_a_base_that_is_not_toml_or_of_a_newer_format_is_named_itself(child, tmp_path):
    place = str(tmp_path / "base" / "study.toml")
    assert faults_of(child("", ("[oil]", "[oil"))).where == place
    error = faults_of(child("", ("format = 1", "format = 99")))
    assert (error.where, error.faults[0].key) == (place, "format")


# Bases that cannot be.


@pytest.mark.parametrize(
    ("chain", "named"),
    [
        ({"a": "a"}, "a.toml → a.toml"),
        ({"a": "b", "b": "a"}, "a.toml → b.toml → a.toml"),
        ({"a": "b", "b": "c", "c": "b"}, "a.toml → b.toml → c.toml → b.toml"),
    ],
)
def test_a_cycle_is_refused_with_its_chain(write, monkeypatch, tmp_path, chain, named):
    monkeypatch.chdir(tmp_path)
    for name, below in chain.items():
        write(f"{name}.toml", f'base = "./{below}.toml"\n')
    error = faults_of("a.toml")
    (fault,) = error.faults
    assert fault.key == "base"
    assert named in fault.rule
    assert "without a base" in fault.remedy
    assert error.where == f"{list(chain)[-1]}.toml"


def test_a_cycle_through_a_link_is_one_too(write, tmp_path):
    (tmp_path / "other.toml").symlink_to(write("a.toml", 'base = "other.toml"\n'))
    assert "cycle" in str(faults_of(tmp_path / "a.toml"))


@pytest.mark.parametrize(
    ("base_file", "content", "rule"),
    [
        ("gone.toml", None, "does not exist"),
        ("../gone/study.toml", None, "does not exist"),
        (".", None, "is a folder"),
        ("empty.toml", b"", "is empty"),
        ("latin.toml", b"\xe9", "UTF-8"),
        ("a" * 300, None, "cannot be read"),
    ],
)
def test_a_base_that_cannot_be_read_is_named_with_key_and_remedy(
    write, tmp_path, base_file, content, rule
):
    path = write("crane/study.toml", f'base = "{base_file}"\n')
    if content is not None:
        (path.parent / base_file).write_bytes(content)
    error = faults_of(path)
    (fault,) = error.faults
    assert error.where == str(path)
    assert (fault.key, fault.value) == ("base", repr(base_file))
    assert rule in fault.rule
    assert "taken from the folder of study.toml" in fault.remedy
    assert "mptune new" not in str(error)


@pytest.mark.parametrize("value", ["1", '""', '" "', '["a.toml"]', "true", '"a\\u0000b"', "{}"])
def test_a_base_that_is_no_file_name_is_refused(write, value):
    (fault,) = faults_of(write("study.toml", f"base = {value}\n")).faults
    assert fault.key == "base"
    assert "is no file name" in fault.rule


def test_a_misspelt_base_comes_with_a_suggestion(write, study_file):
    text = study_file.read_text(encoding="utf-8")
    (fault,) = faults_of(write("study.toml", f'bas = "x.toml"\n{text}')).faults
    assert "`base`" in fault.remedy


@pytest.mark.parametrize("override", ["base=x.toml", "format=1"])
def test_what_belongs_to_a_file_is_not_set_from_the_command_line(study_file, override):
    error = faults_of(study_file, [override])
    assert error.where == "--set"
    assert "at the top of the study" in error.faults[0].remedy


def test_keys_nested_without_end_are_refused_in_words(write):
    error = faults_of(write("study.toml", ".".join("a" * 5000) + " = 1\n"))
    assert "nested too deeply" in str(error)


def test_a_chain_of_bases_has_an_end(write, base):
    """Each file of a folder could name the next."""
    base(name="0.toml")
    for number in range(1, 40):
        path = write(f"{number}.toml", f'base = "{number - 1}.toml"\n')
        if number == 30:
            assert load_study(path).study
    with pytest.raises(InputError, match="more than 30 bases"):
        load_study(path)


def test_what_no_study_is_as_long_as_is_refused_before_it_is_parsed(write):
    with pytest.raises(InputError, match=r"11·10⁶ characters"):
        load_study(write("a.toml", "#" * 11_000_000))
