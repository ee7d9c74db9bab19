"""The studies that come with mptune, by name."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from mptune.errors import Fault, InputError

STUDY_FILE: Final = "study.toml"

_PACKAGE = Path(__file__).parents[1]
_PLACES = (_PACKAGE / "studies", _PACKAGE.parent / "studies")  # in a wheel, in the repository


def bundled_studies() -> dict[str, Path]:
    """Return the file of every study that comes with mptune, by its name."""
    for place in _PLACES:
        found = {path.parent.name: path for path in sorted(place.glob(f"*/{STUDY_FILE}"))}
        if "boom" in found:
            return found
    return {}


def named_study(name: str) -> Path:
    """Return the file of a study that is bundled under this name, or has it as its path.

    Raises
    ------
    InputError
        If there is neither.
    """
    bundled, path = bundled_studies(), Path(name)
    if name in bundled:
        return bundled[name]
    if path.is_dir():
        path /= STUDY_FILE
    if path.is_file():
        return path
    rule = "is neither a bundled study nor a study's file"
    remedy = f"check the path, or name one of {', '.join(bundled)}"
    raise InputError("--like", Fault("", repr(name), rule, remedy))
