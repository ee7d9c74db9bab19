"""Docstrings and signatures agree: numpy sections name what is there, and all of it."""

import inspect
import re

import pytest
from architecture import surface

METHODS = {
    f"{name}.{method}": function
    for name, kind in surface.classes().items()
    for method, function in surface.members(kind).items()
    if not method.startswith("_")
}


def section(docstring, title):
    """Return the names of a numpy section, in order; None where there is no such section."""
    match = re.search(
        rf"^{title}\n-+\n(.*?)(?=^\w[\w ]*\n-+\n|\Z)", docstring, re.DOTALL | re.MULTILINE
    )
    if match is None:
        return None
    lines = re.findall(r"^(?=\S)(.*)$", match[1], re.MULTILINE)
    return [name.strip() for line in lines for name in line.split(" : ")[0].split(",")]


def parameters(function):
    names = list(inspect.signature(function).parameters)
    return [name for name in names if name not in {"self", "cls"}]


def documented(function):
    return section(inspect.getdoc(function) or "", "Parameters")


@pytest.mark.parametrize("name", surface.functions())
def test_a_function_documents_its_parameters(name):
    function = surface.public()[name]
    assert inspect.getdoc(function)
    assert (documented(function) or []) == parameters(function)


@pytest.mark.parametrize("name", METHODS)
def test_a_method_has_a_docstring_that_names_its_parameters_only(name):
    function = METHODS[name]
    assert inspect.getdoc(function)
    assert documented(function) in (None, parameters(function))


@pytest.mark.parametrize("name", surface.classes())
def test_a_class_documents_fields_that_it_has(name):
    kind = surface.classes()[name]
    docstring = inspect.getdoc(kind)
    assert docstring
    named = section(docstring, "Attributes") or []
    assert not named or set(named) <= set(inspect.signature(kind).parameters)
    assert len(named) == len(set(named))


def test_a_section_is_read_to_its_end():
    text = "Do it.\n\nParameters\n----------\none, two\n    Both.\nthree\n    The last.\n"
    text += "\nRaises\n------\nE\n    x"
    assert section(text, "Parameters") == ["one", "two", "three"]
    assert section(text, "Raises") == ["E"]
    assert section(text, "Attributes") is None
