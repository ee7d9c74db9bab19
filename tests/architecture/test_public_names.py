"""The public names: each is what it says, and nothing public speaks of what is not."""

import importlib
import pkgutil
import subprocess
import sys
import typing
from pathlib import Path

import pytest
from architecture import surface

import mptune

FUNCTIONS, CLASSES = surface.functions(), surface.classes()


@pytest.mark.parametrize("name", mptune.__all__)
def test_public_name_is_no_room_and_stays_what_it_is(name):
    rooms = {room.name for room in pkgutil.iter_modules(mptune.__path__)}
    assert name not in rooms
    home, there = mptune._HOMES[name]
    found = getattr(mptune, name)
    assert found is getattr(importlib.import_module(home), there)
    assert getattr(mptune, name) is found


def test_nothing_heavy_is_imported_before_it_is_used():
    heavy = "numpy numba pydantic matplotlib xarray pandas cvxpy control"
    code = f"import mptune, sys; print([one for one in '{heavy}'.split() if one in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


def test_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="nonsense"):
        _ = mptune.nonsense


def test_public_names_are_listed_once_and_in_order():
    assert sorted(mptune.__all__) == sorted(mptune._HOMES)
    assert dir(mptune) == sorted(mptune.__all__)
    assert len(set(mptune._HOMES.values())) == len(mptune._HOMES)


@pytest.mark.parametrize("name", [*FUNCTIONS, *CLASSES])
def test_annotations_name_public_types_only(name):
    known = set(CLASSES.values())
    hidden = {
        kind
        for kind in surface.named_types(surface.public()[name])
        if kind not in known and not surface.is_section(kind)
    }
    assert not hidden, f"{name} names {hidden}"


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_path_may_be_a_plain_string(name):
    for parameter, kind in surface.parameter_types(FUNCTIONS[name]).items():
        if Path in {kind, *typing.get_args(kind)}:
            assert str in typing.get_args(kind), parameter
