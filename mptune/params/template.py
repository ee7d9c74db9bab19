"""A study to start from."""

from __future__ import annotations

import re
from importlib import resources
from pathlib import Path

from mptune.errors import Fault, InputError
from mptune.files import make_folder, write_whole

_LONGEST_NAME = 100  # characters; every file system takes them, with what mptune adds to them


def write_template(folder: str | Path, name: str) -> Path:
    """Write ``<folder>/<name>/study.toml``, every key with its symbol and meaning.

    Raises
    ------
    InputError
        If the name is no folder name or too long for one, or the study is there already.
    """
    if not re.fullmatch(r"[\w][\w.-]*", name):
        fault = Fault("", repr(name), "is no plain folder name", "use letters, digits, - and _")
        raise InputError("NAME", fault)
    if len(name.encode()) > _LONGEST_NAME:
        rule = f"is longer than the {_LONGEST_NAME} bytes that a folder's name may have here"
        raise InputError("NAME", Fault("", repr(name[:20]) + "…", rule, "choose a shorter one"))
    path = Path(folder) / name / "study.toml"
    if path.exists():
        fault = Fault("", "", "exists already", "choose another name, or edit that file")
        raise InputError(path, fault)
    make_folder(path.parent)
    template = resources.files("mptune.params").joinpath("template.toml").read_text("utf-8")
    return write_whole(path, template)
