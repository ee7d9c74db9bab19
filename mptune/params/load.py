"""From a study file to objects: TOML, overrides, validation, and errors in the user's words."""

from __future__ import annotations

import difflib
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ValidationError

from mptune.errors import Fault, InputError
from mptune.files import read_text
from mptune.params.measured import read_measured
from mptune.params.recorded import read_load_table, read_references
from mptune.params.study import ResolvedStudy, Study

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pydantic_core import ErrorDetails

_REMEDY = "check the path, or start a study with `mptune new NAME`"


def load_study(
    path: str | Path, overrides: Sequence[str] = (), uncertainty: str = ""
) -> ResolvedStudy:
    """Read a study file.

    Parameters
    ----------
    path
        The study's TOML file.
    overrides
        ``key=value`` texts that replace values of the file, e.g.
        ``uncertainty.mass=["20 t", "60 t"]``.
    uncertainty
        The name of an uncertainty set under ``[uncertainty.sets]``; empty for the default.

    Raises
    ------
    InputError
        If the file cannot be read, or any value breaks a rule.
    """
    path = Path(path)
    values = parse_toml(path, read_text(path, _REMEDY))
    for override in overrides:
        _override(values, override)
    read_references(path, values)
    read_load_table(path, values)
    read_measured(path, values)
    try:
        study = Study.model_validate(values)
    except ValidationError as error:
        raise InputError(path, *faults_of(error, Study)) from error
    if uncertainty and uncertainty not in study.uncertainty.sets:
        known = ", ".join(sorted(study.uncertainty.sets)) or "none"
        fault = Fault("uncertainty.sets", uncertainty, "is not among the sets", f"known: {known}")
        raise InputError(path, fault)
    chosen = study.uncertainty.chosen(uncertainty)
    half = study.controller.sampling_period / 2
    if study.objective.tracking_loop == "sampled" and chosen.delay[0] < half:
        rule = f"has no hold to run with in a total delay below half a sampling period, {half:g} s"
        remedy = "raise uncertainty.delay, which holds that half, or write continuous"
        raise InputError(path, Fault("objective.tracking_loop", "sampled", rule, remedy))
    return ResolvedStudy(
        name=path.resolve().parent.name if path.stem == "study" else path.stem,
        study=study,
        uncertainty=chosen,
        uncertainty_name=uncertainty,
    )


def parse_toml(path: Path, text: str) -> dict[str, Any]:
    """Return the values of a TOML text.

    Raises
    ------
    InputError
        If the text is not TOML: a truncated file, say.
    """
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        fault = Fault("", "", f"is not valid TOML: {error}", "mend that line")
        raise InputError(path, fault) from error
    except RecursionError as error:
        fault = Fault("", "", "is not usable TOML: nested too deeply", "mend its brackets")
        raise InputError(path, fault) from error


def faults_of(
    error: ValidationError, model: type[BaseModel], remedy: str = "add it to the study"
) -> list[Fault]:
    """Return each error of a validation as a fault in the user's words.

    The ``remedy`` says what to do about a key that is missing.
    """
    faults: dict[str, Fault] = {}
    for detail in error.errors():
        key = _key(detail["loc"])
        faults.setdefault(key, _fault(key, detail, model, remedy))
    return list(faults.values())


def _key(location: tuple[int | str, ...]) -> str:
    # Pydantic appends the member of a union that it tried; no key of ours holds a bracket.
    parts = [part for part in location if not (isinstance(part, str) and _names_a_type(part))]
    key = ""
    for part in parts:
        key += f"[{part + 1}]" if isinstance(part, int) else (f".{part}" if key else part)
    return key


def _names_a_type(part: str) -> bool:
    return "[" in part or part in {"float", "int", "str", "none"}


def _fault(key: str, detail: ErrorDetails, model: type[BaseModel], remedy: str) -> Fault:
    kind, context = detail["type"], detail.get("ctx") or {}
    value = "" if isinstance(detail["input"], dict) else repr(detail["input"])
    if kind == "refused":
        return Fault(key, value, context["rule"], context["remedy"])
    if kind == "missing":
        return Fault(key, "", "is missing", remedy)
    if kind == "extra_forbidden":
        return Fault(key, "", "is an unknown key", _suggestion(key, model))
    if kind == "literal_error":
        return Fault(key, value, "is not a known word", f"choose {context['expected']}")
    return Fault(key, value, detail["msg"][:1].lower() + detail["msg"][1:], "correct the value")


def _suggestion(key: str, model: type[BaseModel]) -> str:
    *parents, last = key.split(".")
    for parent in parents:
        field = model.model_fields.get(parent.split("[")[0])
        inner = getattr(field, "annotation", None)
        if not (isinstance(inner, type) and issubclass(inner, BaseModel)):
            return "remove it, or check its spelling"
        model = inner
    close = difflib.get_close_matches(last, model.model_fields, n=1)
    if close:
        return f"did you mean `{close[0]}`?"
    return f"known here: {', '.join(model.model_fields)}"


def _override(values: dict[str, Any], override: str) -> None:
    key, separator, text = override.partition("=")
    parts = [part.strip() for part in key.split(".")]
    if not separator or not all(parts):
        fault = Fault("", repr(override), "is not key=value", 'write --set "load.force=5 kN"')
        raise InputError("--set", fault)
    try:
        parsed = tomllib.loads(f"value = {text}")
    except tomllib.TOMLDecodeError:
        parsed = {"value": text.strip()}  # a bare quantity: "controller.sampling_period=12 ms"
    if set(parsed) != {"value"}:
        fault = Fault(key.strip(), "", "is given more than one value", "repeat --set for each key")
        raise InputError("--set", fault)
    value = parsed["value"]
    section = values
    for part in parts[:-1]:
        section = section.setdefault(part, {})
        if not isinstance(section, dict):
            fault = Fault(key.strip(), "", "is not inside a section", f"`{part}` holds a value")
            raise InputError("--set", fault)
    section[parts[-1]] = value
