"""A study as the commands load it: what is doubtful about it is said on stderr."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from mptune.params import load

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from mptune.params.study import ResolvedStudy


def load_study(path: Path, overrides: Sequence[str] = (), uncertainty: str = "") -> ResolvedStudy:
    """Return a study, having said on stderr what may be meant otherwise than written.

    Raises
    ------
    InputError
        As ``mptune.params.load.load_study``.
    """
    study = load.load_study(path, overrides, uncertainty)
    for doubt in study.doubts:
        sys.stderr.write(f"mptune: warning: {path}: {doubt}\n")
    return study


def with_warnings(values: dict[str, Any], study: ResolvedStudy) -> dict[str, Any]:
    """Return a result for JSON with the study's doubts beside it, as ``"warnings"``."""
    return {**values, "warnings": [doubt.json() for doubt in study.doubts]}
