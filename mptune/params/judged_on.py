"""The model that gains were judged on, and in what another one differs from it.

A gains file holds the values of the model behind its verdicts, so that the same controller can be
judged elsewhere: on another grid, set or box, on another machine. What must agree is the
controller, with its sampling periods and filters; whatever else differs is said.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mptune.errors import Fault, InputError
from mptune.summary import Summarised
from mptune.units import number

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from mptune.params.study import ResolvedStudy

_CONTROLLER = ("controller.", "estimator.")
_SENSOR = "_noise"  # sensor noise is no part of the controller
_FEW = 8  # values of a list that are kept; of longer ones their hash


@dataclass(frozen=True)
class Difference(Summarised):
    """One key in which two models differ.

    Attributes
    ----------
    key
        The study's key.
    made_for, here
        Its values in print, in SI: where the gains were judged, and here.
    """

    key: str
    made_for: str
    here: str

    @property
    def headline(self) -> str:
        """Key and both values."""
        return f"{self.key}: {self.made_for} in the gains file, {self.here} here"

    def json(self) -> dict[str, str]:
        """Return key and values."""
        return {"key": self.key, "made_for": self.made_for, "here": self.here}


def judged_on(study: ResolvedStudy) -> dict[str, Any]:
    """Return a model's values by dotted key, in SI, as gains files hold them.

    Long lists, tables and measured responses are held by their hash; what is None is left out.
    """
    return dict(_flat("", study.model_values()))


def differences(made_for: dict[str, Any], study: ResolvedStudy) -> tuple[Difference, ...]:
    """Return in what a study's model differs from the one that gains were judged on."""
    here = judged_on(study)
    keys = sorted({*made_for, *here})
    return tuple(
        Difference(key, _text(made_for.get(key)), _text(here.get(key)))
        for key in keys
        if made_for.get(key) != here.get(key)
    )


def refuse_other_controller(path: str | Path, found: tuple[Difference, ...]) -> None:
    """Refuse gains that were made for another controller than a study's.

    Raises
    ------
    InputError
        Naming each key of the controller that differs.
    """
    faults = [
        Fault(
            one.key,
            one.made_for,
            f"is another controller than this study's ({one.here}): gains hold for the sampling "
            "and the filters that they were made for",
            "give the study the same value, or tune again",
        )
        for one in found
        if one.key.startswith(_CONTROLLER) and not one.key.endswith(_SENSOR)
    ]
    if faults:
        raise InputError(path, *faults)


def _flat(prefix: str, values: Any) -> Iterator[tuple[str, Any]]:
    for key, value in values.items():
        name = f"{prefix}{key}"
        if isinstance(value, dict):
            yield from _flat(f"{name}.", value)
        elif value is not None:
            yield name, _kept(value)


def _kept(value: Any) -> Any:
    plain = json.loads(json.dumps(value))
    if not isinstance(plain, list):
        return plain
    text = json.dumps(plain, sort_keys=True)
    parts = [part for one in plain for part in (one if isinstance(one, list) else [one])]
    if len(parts) <= _FEW and not any(isinstance(part, dict | list | None) for part in parts):
        return plain
    return f"{len(plain)} entries, sha256 {hashlib.sha256(text.encode()).hexdigest()[:16]}"


def _text(value: Any) -> str:
    if value is None:
        return "—"
    if isinstance(value, list):
        return f"[{', '.join(_text(one) for one in value)}]"
    if isinstance(value, float):
        return number(value, 6)
    return str(value)
