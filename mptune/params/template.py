"""A study to start from."""

from __future__ import annotations

import re
from importlib import resources
from pathlib import Path

from mptune.errors import Fault, InputError
from mptune.files import make_folder, write_whole
from mptune.params.bundled import STUDY_FILE, named_study
from mptune.params.likeness import write_alike

_LONGEST_NAME = 100  # characters; every file system takes them, with what mptune adds to them


def write_template(folder: str | Path, name: str, like: str = "") -> Path:
    """Write ``<folder>/<name>/study.toml``, every key with its symbol and meaning.

    Parameters
    ----------
    folder
        Where studies live.
    name
        Of the study and its folder.
    like
        A bundled study's name, or the path of a study, to be like; the template where empty.

    Raises
    ------
    InputError
        If the name is no folder name or too long for one, the study is there already, or the one
        that it is to be like cannot be loaded.
    """
    if not re.fullmatch(r"[\w][\w.-]*", name):
        fault = Fault("", repr(name), "is no plain folder name", "use letters, digits, - and _")
        raise InputError("NAME", fault)
    if len(name.encode()) > _LONGEST_NAME:
        rule = f"is longer than the {_LONGEST_NAME} bytes that a folder's name may have here"
        raise InputError("NAME", Fault("", repr(name[:20]) + "…", rule, "choose a shorter one"))
    path = Path(folder) / name / STUDY_FILE
    if path.exists():
        fault = Fault("", "", "exists already", "choose another name, or edit that file")
        raise InputError(path, fault)
    if like:
        return write_alike(path, named_study(like))
    make_folder(path.parent)
    template = resources.files("mptune.params").joinpath("template.toml").read_text("utf-8")
    return write_whole(path, template)
