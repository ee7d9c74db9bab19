"""Studies with a base: what they take, what they override, and who is named when it is wrong."""

from __future__ import annotations

import tomllib

import pytest
import tomlkit
from hypothesis import given, settings
from hypothesis import strategies as st

from mptune.errors import InputError
from mptune.params.load import load_study

MOVE = '[[manoeuvre]]\nkind = "file"\nfile = "move.csv"\nrest = "1 s"\n'
RECORDED = "time [s],position [mm]\n" + "".join(f"{n},{n}\n" for n in range(5))
MEASURED = "frequency [Hz],re,im\n" + "".join(f"{n},0.5,-0.{n}\n" for n in range(1, 6))


@pytest.fixture
def write(tmp_path):
    def write(name, text):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    return write


@pytest.fixture
def base(write, study_file):
    """Write the boom study as a base in a folder of its own, with some text replaced."""

    def write_base(*replaced, name="base/study.toml"):
        text = study_file.read_text(encoding="utf-8")
        for old, new in replaced:
            assert old in text
            text = text.replace(old, new)
        return write(name, text)

    return write_base


@pytest.fixture
def child(write, base):
    """Write a study over the boom study."""

    def write_child(text="", *replaced):
        base(*replaced)
        return write("crane/study.toml", f'base = "../base/study.toml"\n{text}')

    return write_child


def faults_of(path, overrides=()):
    with pytest.raises(InputError) as caught:
        load_study(path, overrides)
    return caught.value


# What a study takes and what it overrides.


def test_the_second_boom_is_what_it_was_when_it_was_written_out(root):
    now = load_study(root / "studies" / "boom-2dof" / "study.toml")
    before = load_study(root / "tests" / "unit" / "params" / "boom-2dof-written-out.toml")
    assert now.hash() == before.hash()
    assert now.model_values() == before.model_values()
    assert now.title == before.title
    taken_along = {"uncertainty": {"sets"}, "systems": True, "sources": True}
    assert now.study.model_dump(exclude=taken_along) == before.study.model_dump(exclude=taken_along)


def test_a_byte_order_mark_is_no_part_of_a_study(write, base):
    plain = load_study(base())
    marked = "\ufeff" + base().read_text(encoding="utf-8").replace("\n", "\r\n")
    assert load_study(write("base/study.toml", marked)).hash() == plain.hash()
    over = write("crane/study.toml", '\ufeffbase = "../base/study.toml"\n')
    assert load_study(over).hash() == plain.hash()


def test_every_value_of_the_second_boom_has_a_source_and_none_is_left_to_chance(root):
    path = root / "studies" / "boom-2dof" / "study.toml"
    study = load_study(path).study
    own = tomllib.loads(path.read_text(encoding="utf-8"))
    assert study.source_of("uncertainty.delay") == "published: §5.1"
    assert study.source_of("uncertainty.mass") == "published: Fig. 5"
    assert study.source_of("cylinder.bore").startswith("derived: area ratio")
    assert own["sources"].items() <= study.sources.items()
    assert not any("states no source" in source for source in study.sources.values())


def as_said(study, *but):
    """Return a study's values, but for the neighbours that it names from its own folder."""
    return study.study.model_dump(exclude={"systems": {"beside"}, **dict.fromkeys(but, True)})


def test_a_base_alone_is_the_same_study(child, boom):
    study = load_study(child())
    assert study.hash() == boom.hash()
    assert as_said(study) == as_said(boom)
    assert study.name == "crane"


def test_one_key_of_a_nested_table_and_one_range_are_overridden(child, write_study):
    text = '[uncertainty]\nmass = ["20 t", "60 t"]\n[requirements.bounds]\ntau = ["6 ms", "9 ms"]\n'
    study = load_study(child(text))
    assert study.uncertainty.mass == (20e3, 60e3)
    assert study.uncertainty.delay == (0.011, 0.0215)
    assert study.study.requirements.bounds.tau == (0.006, 0.009)
    assert study.study.requirements.bounds.k_i_pos == (22.0, 200.0)
    changes = {"uncertainty.mass": '["20 t", "60 t"]'}
    changes["requirements.bounds.tau"] = '["6 ms", "9 ms"]'
    assert study.hash() == load_study(write_study(changes)).hash()


def test_a_list_is_replaced_whole(child):
    move = '[[manoeuvre]]\ndistance = "5 mm"\nduration = "1 s"\nrest = "0 s"\n'
    study = load_study(child(move)).study
    assert [one.distance for one in study.manoeuvre] == [0.005]


def test_a_named_set_is_changed_and_another_one_added(child):
    text = "[uncertainty.sets.section-5-1]\npoints = 3\n[uncertainty.sets.small]\npoints = 2\n"
    path = child(text + 'mass = ["1 t", "2 t"]\ndelay = ["5 ms", "9 ms"]\n')
    overrides = [f"uncertainty.sets.small.tau_{side}=derived" for side in "ab"]
    assert load_study(path, overrides, "small").uncertainty.mass == (1e3, 2e3)
    box = load_study(path, overrides, "section-5-1").uncertainty
    assert (box.points, box.delay) == (3, (0.010, 0.014))


def test_bases_chain_and_the_nearest_wins(child, write):
    child('[gains]\nxi = 0.6\n[load]\nforce = "5 kN"\n')
    top = write("tower.toml", 'base = "crane/study.toml"\n[gains]\nxi = 0.7\n')
    study = load_study(top)
    assert (study.study.gains.xi, study.study.load.force) == (0.7, 5e3)
    assert study.study.cylinder.bore == 0.08
    assert study.name == "tower"


def test_the_command_line_lies_over_all(child):
    study = load_study(child("[gains]\nxi = 0.6\n"), ["gains.xi=0.8", "load.force=5 kN"]).study
    assert (study.gains.xi, study.load.force) == (0.8, 5e3)


def test_a_base_behind_a_link_to_a_folder_is_the_one_that_the_system_finds(base, write, tmp_path):
    base(name="deep/base/study.toml")
    write("deep/crane/study.toml", 'base = "../base/study.toml"\n')
    (tmp_path / "link").symlink_to(tmp_path / "deep" / "crane")
    assert load_study(tmp_path / "link" / "study.toml").study.cylinder.bore == 0.08


SPLIT = settings(max_examples=15, deadline=None)


def leaves(values, *parents):
    for key, value in values.items():
        if isinstance(value, dict) and (*parents, key) != ("sources",):
            yield from leaves(value, *parents, key)
        else:
            yield (*parents, key), value


@SPLIT
@given(data=st.data())
def test_however_its_values_are_spread_over_files_it_is_the_same_study(
    study_file, boom, tmp_path_factory, data
):
    """Each value stands in the base, in the study, or in both, where the base's is another one."""
    written = list(leaves(tomllib.loads(study_file.read_text(encoding="utf-8"))))
    count = len(written)
    places = data.draw(st.lists(st.sampled_from("bso"), min_size=count, max_size=count))
    layers = {"base": {}, "study": {}}
    for (key, value), place in zip(written, places, strict=True):
        for name in {"b": ["base"], "s": ["study"], "o": ["base", "study"]}[place]:
            section = layers[name]
            for part in key[:-1]:
                section = section.setdefault(part, {})
            hidden = name == "base" and place == "o" and key != ("format",)
            section[key[-1]] = 1.0 if hidden else value
    folder = tmp_path_factory.mktemp("split")
    for name, values in layers.items():
        head = {"base": "base.toml"} if name == "study" else {}
        (folder / f"{name}.toml").write_text(tomlkit.dumps(head | values), encoding="utf-8")
    study = load_study(folder / "study.toml")
    assert study.hash() == boom.hash()
    assert as_said(study, "sources") == as_said(boom, "sources")


# Sources.

OF_BASE = "derived: area ratio"


@pytest.mark.parametrize(
    ("text", "bore", "rod"),
    [
        ("", OF_BASE, OF_BASE),
        ('[cylinder]\nbore = "80 mm"\n', OF_BASE, OF_BASE),  # the same value
        ('[cylinder]\nbore = "90 mm"\n', "assumed: set in crane/study.toml", OF_BASE),
        (
            '[cylinder]\nbore = "90 mm"\n[sources]\n"cylinder.bore" = "measured: on the rig"\n',
            "measured: on the rig",
            OF_BASE,
        ),
        (
            '[cylinder]\nbore = "90 mm"\n[sources]\ncylinder = "measured: on the rig"\n',
            "measured: on the rig",
            OF_BASE,
        ),
        ('[sources]\n"cylinder.rod" = "measured: too"\n', OF_BASE, "measured: too"),
    ],
)
def test_a_value_has_the_source_of_the_file_that_wrote_it(child, text, bore, rod):
    study = load_study(child(text)).study
    assert study.source_of("cylinder.bore").startswith(bore)
    assert study.source_of("cylinder.rod").startswith(rod)
    assert study.source_of("cylinder.dead_volume_a") == "published: Table 1"


def test_a_source_of_a_section_stands_before_the_bases_of_a_single_value(child):
    text = '[cylinder]\ndead_volume_a = "0.5 dm^3"\n[sources]\ncylinder = "measured: here"\n'
    study = load_study(child(text)).study
    assert study.source_of("cylinder.dead_volume_a") == "measured: here"
    assert study.source_of("cylinder.dead_volume_b") == "published: Table 1"


def test_the_same_source_said_again_changes_nothing(child, boom):
    text = '[controller]\nsampling_period = "10 ms"\n[sources]\ncontroller = "published: Table 2"\n'
    assert load_study(child(text)).study.sources == boom.study.sources


def test_a_replaced_list_loses_the_source_of_the_list_it_replaces(child):
    move = '[[manoeuvre]]\ndistance = "5 mm"\nduration = "1 s"\nrest = "0 s"\n'
    assert "crane/study.toml" in load_study(child(move)).study.source_of("manoeuvre")


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


# File names inside a study are taken from the folder of the file that wrote them.


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
