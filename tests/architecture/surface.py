"""The public surface, walked: which types its annotations name, wherever they are imported."""

from __future__ import annotations

import ast
import importlib
import inspect
import sys
import typing
from functools import cache, cached_property

from pydantic import BaseModel

import mptune

ELSEWHERE = ("builtins", "typing", "collections", "numpy", "xarray", "pandas", "control")
ELSEWHERE += ("matplotlib", "pathlib", "types", "enum")


def public():
    """Return every public name with what it stands for."""
    return {name: getattr(mptune, name) for name in mptune.__all__}


def is_section(kind):
    """Return whether a type is a part of a study, which may stay in mptune.params."""
    return issubclass(kind, BaseModel) and kind.__module__.startswith("mptune.params")


def functions():
    """Return the public functions by their public names."""
    return {name: one for name, one in public().items() if inspect.isfunction(one)}


def classes():
    """Return the public classes by their public names."""
    return {name: one for name, one in public().items() if inspect.isclass(one)}


def members(kind):
    """Return the public methods and properties of a class that mptune defines, as functions."""
    found = {}
    for base in kind.__mro__:
        if not base.__module__.startswith("mptune"):
            continue
        for name, value in vars(base).items():
            if name.startswith("_") and name not in {"__init__", "__call__"}:
                continue
            function = _function(value)
            if function is not None:
                found.setdefault(name, function)
    return found


def _function(value):
    if isinstance(value, property):
        return value.fget
    if isinstance(value, cached_property):
        return value.func
    if isinstance(value, classmethod | staticmethod):
        return value.__func__
    return value if inspect.isfunction(value) else None


def named_types(one):
    """Return the types of mptune that a function's or a class's annotations name."""
    if inspect.isfunction(one):
        annotations = _annotations(inspect.unwrap(one))
    else:
        annotations = []
        for base in one.__mro__:
            if base.__module__.startswith("mptune"):
                names = _namespace(base.__module__) | vars(base)
                own = vars(base).get("__annotations__", {})
                fields = {name: text for name, text in own.items() if not name.startswith("_")}
                annotations += [_evaluated(text, names) for text in fields.values()]
        for function in members(one).values():
            annotations += _annotations(function)
    found = set()
    for annotation in annotations:
        _collect(annotation, found)
    return found


def parameter_types(function):
    """Return the types of a function's parameters by their names."""
    inner = inspect.unwrap(function)
    names, own = _namespace(inner.__module__), inner.__annotations__
    return {name: _evaluated(text, names) for name, text in own.items() if name != "return"}


def _annotations(function):
    names = _namespace(function.__module__)
    return [_evaluated(text, names) for text in function.__annotations__.values()]


def _evaluated(annotation, names):
    if isinstance(annotation, typing.ForwardRef):
        annotation = annotation.__forward_arg__
    if isinstance(annotation, str):
        return eval(annotation, names)  # noqa: S307  # mptune's own annotations
    return annotation


@cache
def _namespace(module):
    """Return a module's names, those imported for type checking included."""
    loaded = importlib.import_module(module)
    names = dict(vars(loaded))
    for node in ast.walk(ast.parse(inspect.getsource(sys.modules[module]))):
        if isinstance(node, ast.If) and getattr(node.test, "id", "") == "TYPE_CHECKING":
            exec(compile(ast.Module(node.body, []), module, "exec"), names)  # noqa: S102  # imports
    return names


def _collect(annotation, found):
    for argument in typing.get_args(annotation):
        for one in argument if isinstance(argument, list) else [argument]:
            _collect(one, found)
    origin = typing.get_origin(annotation) or annotation
    if inspect.isclass(origin) and origin.__module__.split(".")[0] not in ELSEWHERE:
        found.add(origin)
