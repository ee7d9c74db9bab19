"""``--set key=value`` replaces any key of the study."""

from __future__ import annotations

import pytest
import tomlkit
from hostile import TEXTS

from mptune.errors import InputError
from mptune.params.load import load_study


def fault_of(study_file, override):
    with pytest.raises(InputError) as caught:
        load_study(study_file, [override])
    (fault,) = caught.value.faults
    return caught.value.where, fault


@pytest.mark.parametrize(
    ("override", "value"),
    [
        ("load.force=5 kN", 5000.0),
        ('load.force="5 kN"', 5000.0),
        ("load.force='5 kN'", 5000.0),
        ("  load.force  =  5 kN  ", 5000.0),
        ("load.force=-5e3 N", -5000.0),
    ],
)
def test_a_quantity_may_be_bare_or_quoted(study_file, override, value):
    assert load_study(study_file, [override]).study.load.force == value


def test_a_range_is_written_as_in_the_file(study_file):
    study = load_study(study_file, ['uncertainty.mass=["20 t", "60 t"]'])
    assert study.uncertainty.mass == (20e3, 60e3)


def test_a_plain_number_is_written_as_in_the_file(study_file):
    assert load_study(study_file, ["gains.xi=0.7"]).study.gains.xi == 0.7


def test_a_word_may_be_bare(study_file):
    study = load_study(study_file, ["model.measurement_path=filters"])
    assert study.study.model.measurement_path == "filters"


def test_a_key_that_the_file_leaves_out_may_be_set(study_file):
    study = load_study(study_file, ["uncertainty.nominal.mass=30 t"])
    assert study.uncertainty.nominal_mass == 30e3


def test_a_key_of_a_named_set_may_be_set(study_file):
    override = 'uncertainty.sets.section-5-1.mass=["20 t", "60 t"]'
    study = load_study(study_file, [override], "section-5-1")
    assert study.uncertainty.mass == (20e3, 60e3)


def test_a_new_set_may_be_written_in_one_override(study_file):
    box = '{mass=["1 t", "2 t"], delay=["5 ms", "9 ms"], tau_a="derived", tau_b="derived"}'
    study = load_study(study_file, [f"uncertainty.sets.small={box}"], "small")
    assert study.uncertainty.mass == (1e3, 2e3)


def study_with_set(study_file, tmp_path, name):
    """Write the study with a set of any name."""
    document = tomlkit.parse(study_file.read_text(encoding="utf-8"))
    document["uncertainty"]["sets"][name] = dict(document["uncertainty"]["sets"]["section-5-1"])
    path = tmp_path / "study.toml"
    path.write_text(tomlkit.dumps(document), encoding="utf-8")
    return path


NAMES = [text for text in (*TEXTS, "a.mass", "a=b", "[a]") if text and "\udcff" not in text]


@pytest.mark.parametrize("name", NAMES, ids=range(len(NAMES)))
def test_a_set_of_any_name_is_named_by_its_key(study_file, tmp_path, name):
    """The page turns a set's values by ``--set``: no name may reach beyond its own set."""
    path = study_with_set(study_file, tmp_path, name)
    plain = load_study(path, (), name)
    changed = load_study(path, [f'{plain.key_of("mass")}=["30 t", "40 t"]'], name)
    assert changed.uncertainty.mass == (30e3, 40e3)
    before, after = (one.study.uncertainty.sets for one in (plain, changed))
    assert before.keys() == after.keys()
    assert all(before[one] == after[one] for one in before if one != name)


def test_the_last_of_several_overrides_wins(study_file):
    study = load_study(study_file, ["load.force=5 kN", "load.force=6 kN"])
    assert study.study.load.force == 6e3


def test_the_file_itself_is_not_changed(study_file):
    before = study_file.read_bytes()
    load_study(study_file, ["load.force=5 kN"])
    assert study_file.read_bytes() == before


@pytest.mark.parametrize(
    "override", ["", "load.force", "=5 kN", " = 5 kN", "load..force=5 kN", ".=5", "load.=5"]
)
def test_what_is_not_key_and_value_is_refused(study_file, override):
    where, fault = fault_of(study_file, override)
    assert where == "--set"
    assert fault.value == repr(override)
    assert "key=value" in fault.rule
    assert "--set" in fault.remedy


@pytest.mark.parametrize(
    ("override", "holder"),
    [("cylinder.bore.x=5 mm", "bore"), ("manoeuvre.distance=5 mm", "manoeuvre")],
)
def test_a_key_inside_a_value_is_refused(study_file, override, holder):
    where, fault = fault_of(study_file, override)
    assert where == "--set"
    assert fault.key == override.split("=")[0]
    assert f"`{holder}`" in fault.remedy


@pytest.mark.parametrize(
    ("override", "key", "rule"),
    [
        ("load.force=5 kg", "load.force", "wrong dimension"),
        ("load.force=", "load.force", "number"),
        ("load.force=5", "load.force", "no unit"),
        ('uncertainty.mass=["20 t", "60 t"', "uncertainty.mass", "number"),
        ("uncertainty.mass=20 t", "uncertainty.mass", "single value"),
        ("load.forse=5 kN", "load.forse", "unknown key"),
        ("lode.force=5 kN", "lode", "unknown key"),
        ("gains.xi=high", "gains.xi", "number"),
    ],
)
def test_a_bad_value_is_refused_as_in_the_file(study_file, override, key, rule):
    _, fault = fault_of(study_file, override)
    assert fault.key == key
    assert rule in fault.rule


def test_more_than_one_value_is_refused_and_not_dropped(study_file):
    _, fault = fault_of(study_file, 'load.force="5 kN"\ngains.xi = 0.7')
    assert fault.rule
