"""Studies with a base: what they take, what they override, and the sources of their values."""

from __future__ import annotations

import tomllib

import pytest
import tomlkit
from hypothesis import given, settings
from hypothesis import strategies as st

from mptune.params.load import load_study

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
