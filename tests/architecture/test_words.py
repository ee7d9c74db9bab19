"""Words that other programs rely on, and what every value must carry."""

from __future__ import annotations

import ast
import tomllib
from pathlib import Path

import pytest
from pydantic import BaseModel

from mptune.params.study import SOURCE_KINDS, Study
from mptune.units import registry

ROOT = Path(__file__).parents[2]
PROMISED_KEYS = {
    "cylinder": {"bore", "rod", "stroke", "dead_volume_a", "dead_volume_b"},
    "oil": {"bulk_modulus", "bulk_modulus_estimate"},
    "hose": set(),
    "valves": set(),
    "supplies": set(),
    "load": {"force"},
    "controller": {"sampling_period", "fast_sampling_period", "pressure_min", "pressure_max"},
    "uncertainty": {"mass", "delay", "tau_a", "tau_b", "points", "nominal", "sets"},
    "model": {"measurement_path"},
    "gains": {"k_p_vel", "k_p_pos", "k_i_pos", "omega", "xi", "tau"},
    "feedforward": {"acceleration_mass", "reference_lag", "velocity_reference_lag"},
    "requirements": {
        "velocity_ratio",
        "position_ratio",
        "sensitivity_peak",
        "complementary_peak",
        "gain_margin",
        "noise_gain",
        "bounds",
    },
    "objective": {"kind"},
    "manoeuvre": set(),
    "verification": {
        "masses",
        "valve_delays",
        "oil_bulk_moduli",
        "load_forces",
        "seeds",
        "repeats",
    },
    "identification": {
        "amplitude",
        "frequency",
        "frequencies",
        "positions",
        "velocities",
        "pressures",
        "oil_bulk_moduli",
        "valve_delays",
    },
}
NUMBERS_OF_THEIR_OWN = {
    "Load.table",
    "Manoeuvre.samples",
    "MeasuredResponse.phases",
    "MeasuredResponse.rows",
    "Requirements.velocity_ratio",
    "Requirements.position_ratio",
}


def sections(model):
    """Yield a model and every model inside it."""
    yield model
    for field in model.model_fields.values():
        for part in (field.annotation, *getattr(field.annotation, "__args__", ())):
            if isinstance(part, type) and issubclass(part, BaseModel):
                yield from sections(part)


SECTIONS = sorted(set(sections(Study)), key=lambda section: section.__name__)


def leaves(values, prefix=""):
    """Yield the dotted key of every value of a study file."""
    for key, value in values.items():
        if isinstance(value, dict):
            yield from leaves(value, f"{prefix}{key}.")
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            for item in value:
                yield from leaves(item, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}"


BOOM = tomllib.loads((ROOT / "studies" / "boom" / "study.toml").read_text(encoding="utf-8"))
BOOM_VALUES = sorted(
    {key for key in leaves(BOOM) if not key.startswith(("sources.", "title", "format"))}
)


@pytest.mark.parametrize(("section", "keys"), PROMISED_KEYS.items())
def test_the_promised_keys_of_a_study_exist(section, keys):
    assert section in Study.model_fields
    annotation = Study.model_fields[section].annotation
    model = getattr(annotation, "__args__", (annotation,))[0]
    assert keys <= set(model.model_fields)


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.__name__)
def test_every_quantity_has_unit_symbol_and_meaning(section):
    for name, unit, symbol, meaning in section.quantities():
        assert unit == "1" or registry().parse_units(unit), name
        assert symbol, name
        assert meaning, name


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.__name__)
def test_no_number_stands_outside_a_quantity(section):
    quantities = {name for name, *_ in section.quantities()}
    for name, field in section.model_fields.items():
        if "float" in str(field.annotation) and name not in quantities:
            assert f"{section.__name__}.{name}" in NUMBERS_OF_THEIR_OWN


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.__name__)
def test_every_field_of_a_study_is_described(section):
    for name, field in section.model_fields.items():
        annotation = str(field.annotation)
        is_section = any(part.__name__ in annotation for part in SECTIONS)
        assert field.description or is_section or name == "sources", name


@pytest.mark.parametrize("key", BOOM_VALUES)
def test_every_value_of_the_boom_study_has_a_source(boom, key):
    source = boom.study.source_of(key)
    assert source.startswith(SOURCE_KINDS), f"{key} has no source"


@pytest.mark.parametrize("key", sorted(BOOM["sources"]))
def test_every_source_of_the_boom_study_points_at_a_value(boom, key):
    values = boom.study.model_dump()
    for part in key.split("."):
        assert part in values
        values = values[part]


def public_definitions(tree):
    for node in tree.body:
        kinds = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef
        if isinstance(node, kinds) and not node.name.startswith("_"):
            yield node
            if isinstance(node, ast.ClassDef):
                is_protocol = any("Protocol" in ast.unparse(base) for base in node.bases)
                if not is_protocol:  # described as a whole, under Attributes
                    yield from public_definitions(node)


@pytest.mark.parametrize(
    "path",
    sorted((ROOT / "mptune").rglob("*.py")),
    ids=lambda path: str(path.relative_to(ROOT)),
)
def test_every_module_function_and_class_has_a_docstring(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    assert ast.get_docstring(tree), "the module has none"
    bare = [node.name for node in public_definitions(tree) if not ast.get_docstring(node)]
    assert bare == []


@pytest.mark.parametrize("path", sorted((ROOT / "tests" / "reference").glob("*.py")))
def test_reference_programs_import_nothing_of_mptune(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            assert all(not alias.name.startswith("mptune") for alias in node.names)
        if isinstance(node, ast.ImportFrom):
            assert not node.module.startswith("mptune")
