"""TOML and JSON: the same numbers, to the last bit, with provenance and verdict."""

import json
import tomllib

import pytest

from mptune.export.table import as_json, as_toml


@pytest.mark.parametrize("which", ["controller", "single", "forced"])
def test_toml_and_json_hold_the_numbers_to_the_last_bit(request, which):
    controller = request.getfixturevalue(which)
    table, values = tomllib.loads(as_toml(controller)), json.loads(as_json(controller))
    for name, numbers in controller.numbers.sections.items():
        for one in numbers:
            assert table[name][one.key] == one.value
            assert values[name][one.key]["value"] == one.value
            assert values[name][one.key]["unit"] == one.unit
    assert table["gains"] == controller.gains.model_dump()
    assert table["provenance"] == values["provenance"] == controller.provenance()
    assert table["verdict"] == values["verdict"]
    assert table["format"] == values["format"] == 1


def test_provenance_names_study_version_dates_and_precision(controller, study):
    provenance = tomllib.loads(as_toml(controller))["provenance"]
    assert provenance["study_hash"] == study.hash()
    assert provenance["gains_hash"] == controller.source.content_hash()
    assert provenance["precision"] == "double"
    assert {"version", "date", "gains_date", "uncertainty"} <= set(provenance)


def test_the_verdict_holds_every_requirement_with_its_figure(controller):
    verdict = tomllib.loads(as_toml(controller))["verdict"]
    assert (verdict["margins"], verdict["forced"]) == ("satisfied", False)
    found = {one["requirement"]: one["found"] for one in verdict["requirements"]}
    assert found["velocity_ratio (Eq. 17)"] == pytest.approx(0.510, abs=1e-3)


def test_forced_files_say_so_loudly(forced):
    assert "NOT satisfied" in as_toml(forced).split("[provenance]")[0]
    values = json.loads(as_json(forced))
    assert "NOT satisfied" in values["warning"]
    assert (values["verdict"]["margins"], values["verdict"]["forced"]) == ("violated", True)


def test_every_number_carries_unit_and_meaning_in_a_comment(controller):
    lines = as_toml(controller).splitlines()
    (line,) = [line for line in lines if line.startswith("weight_loss")]
    assert line.endswith("# N/J, W_loss")
