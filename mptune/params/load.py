"""From a study's files to objects: bases, overrides, validation, and errors in the user's words."""

from __future__ import annotations

import contextlib
import difflib
import os
import re
import reprlib
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ValidationError

from mptune.errors import Fault, InputError
from mptune.escaping import file_name
from mptune.files import read_text
from mptune.params.beside import name_beside
from mptune.params.coherence import doubts_of, refusals_of
from mptune.params.extent import faults_of_extent
from mptune.params.format import FORMAT_KEY, STUDY_FORMAT
from mptune.params.layers import Layers
from mptune.params.lines import missing_supplies, supplies_of
from mptune.params.measured import read_measured
from mptune.params.recorded import read_load_table, read_references
from mptune.params.study import ResolvedStudy, Study

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pydantic_core import ErrorDetails

    from mptune.params.uncertainty import UncertaintySet

_BASE = "base"
_OF_A_FILE = (FORMAT_KEY, _BASE)
_REMEDY = "check the path, or start a study with `mptune new NAME`"

_ADD_IT = "add it to the study"
_DEEPEST = 16  # tables and lists within one another; studies have 5
_MOST_FAULTS = 8  # of a file, in words; the rest is counted
_PART = re.compile(r'\s*(?:("(?:[^"\\]|\\.)*")\s*|([^.=]*))([.=]|\Z)', re.DOTALL)  # of a key
_MOST_BASES = 30  # of a study, one behind the other; studies have 2
_LARGEST = 10_000_000  # characters of TOML, which take seconds to read
_WHOLE = "name a study or a gains file, which have some thousands"
_TOO_LARGE = "is a whole number beyond 64 bits", "write a smaller one, or one with a point"
_BRIEF = reprlib.Repr()
_BRIEF.maxstring = _BRIEF.maxother = _BRIEF.maxlong = 90


def load_study(
    path: str | Path, overrides: Sequence[str] = (), uncertainty: str = ""
) -> ResolvedStudy:
    """Read a study file, and those that it is based on.

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
        If a file cannot be read, is based on itself, any value breaks a rule, or values that are
        right by themselves cannot be simulated together. It names the file that the value was
        written in. What is merely doubtful the study carries, see ``ResolvedStudy.doubts``.
    """
    path = Path(path)
    layers = read_layers(path)
    for override in overrides:
        layers.override(*_key_and_value(override))
    read_references(layers)
    read_load_table(layers)
    read_measured(layers)
    name_beside(layers)
    try:
        study = Study.model_validate(layers.values)
    except ValidationError as error:
        raise layers.refusal(*faults_of(error, Study)) from error
    study = study.model_copy(update={"supplies": supplies_of(study.lines, study.supplies)})
    if absent := missing_supplies(study.supplies):
        raise layers.refusal(*(Fault(key, "", "is missing", _ADD_IT) for key in absent))
    if uncertainty and uncertainty not in study.uncertainty.sets:
        known = ", ".join(sorted(study.uncertainty.sets)) or "none"
        fault = Fault("uncertainty.sets", uncertainty, "is not among the sets", f"known: {known}")
        raise InputError(path, fault)
    chosen = study.uncertainty.chosen(uncertainty).with_delays(study.summed_delay)
    written = frozenset(study.verification.model_fields_set)
    study = _with_machines(study, chosen)
    impossible = refusals_of(study, written)
    if impossible:
        raise layers.refusal(*impossible)
    half = study.controller.sampling_period / 2
    if study.objective.runs and chosen.explicit_delay[0] < half:
        rule = f"has no hold to run with in a total delay below half a sampling period, {half:g} s"
        remedy = "raise uncertainty.delay_as_it_runs, which holds that half, or write continuous"
        sampled = study.objective.tracking_loop == "sampled"
        key, value = ("tracking_loop", "sampled") if sampled else ("kind", "robustness")
        raise layers.refusal(Fault(f"objective.{key}", value, rule, remedy))
    resolved = ResolvedStudy(
        name=file_name(path.resolve().parent.name if path.stem == "study" else path.stem),
        study=study,
        uncertainty=chosen,
        uncertainty_name=uncertainty,
    )
    if faults := list(faults_of_extent(resolved)):
        raise layers.refusal(*faults)
    return resolved.model_copy(update={"doubts": doubts_of(resolved)})


def _with_machines(study: Study, chosen: UncertaintySet) -> Study:
    """Return the study with the machines that its ``[verification]`` leaves to its ranges."""
    verification = study.verification.filled(
        chosen.mass, study.valves.delay, study.oil.bulk_modulus, study.load.force
    )
    return study.model_copy(update={"verification": verification})


def read_layers(path: Path) -> Layers:
    """Return the values of a study laid over those of its base, and of the base's base.

    Raises
    ------
    InputError
        If a file cannot be read, or is based on itself.
    """
    written: list[tuple[Path, dict[str, Any]]] = []
    text = read_text(path, _REMEDY)
    while True:
        values = parse_toml(path, text)
        STUDY_FORMAT.take(path, values)
        base = values.pop(_BASE, None)
        written.insert(0, (path, values))
        if base is None:
            break
        if len(written) > _MOST_BASES:
            rule = f"is one more than {_MOST_BASES} bases, each of the next"
            raise InputError(path, Fault(_BASE, repr(base), rule, "write the last ones into one"))
        path, text = _read_base(base, [file for file, _ in reversed(written)])
    try:
        return Layers.of(written)
    except RecursionError as error:
        fault = Fault("", "", "is not usable: nested too deeply", "shorten its keys")
        raise InputError(written[-1][0], fault) from error


def _read_base(base: Any, files: Sequence[Path]) -> tuple[Path, str]:
    """Return path and text of the base that the last of these files names."""
    file = files[-1]
    if not isinstance(base, str) or not base.strip() or "\0" in base:
        fault = Fault(_BASE, repr(base), "is no file name", f'write {_BASE} = "../boom/study.toml"')
        raise InputError(file, fault)
    joined = file.parent / base
    path = Path(os.path.normpath(joined))
    if os.path.realpath(path) != os.path.realpath(joined):
        path = joined  # behind a link to a folder, ".." is another one's parent
    try:
        text = read_text(path)
    except InputError as error:
        rule = f"names {path}, which {error.faults[0].rule}"
        remedy = f"mend that file, or the path: it is taken from the folder of {file.name}"
        raise InputError(file, Fault(_BASE, repr(base), rule, remedy)) from error
    if os.path.realpath(path) in map(os.path.realpath, files):
        chain = " → ".join(map(str, (*files, path)))
        fault = Fault(_BASE, repr(base), f"closes a cycle: {chain}", "let one stand without a base")
        raise InputError(file, fault)
    return path, text


def parse_toml(path: Path, text: str) -> dict[str, Any]:
    """Return the values of a TOML text.

    Raises
    ------
    InputError
        If the text is not TOML: a truncated file, say; or if it is longer than any study.
    """
    if len(text) > _LARGEST:
        fault = Fault("", "", f"has {len(text) / 1e6:.0f}·10⁶ characters of TOML", _WHOLE)
        raise InputError(path, fault)
    try:
        values = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        fault = Fault("", "", f"is not valid TOML: {error}", "mend that line")
        raise InputError(path, fault) from error
    except RecursionError as error:
        fault = Fault("", "", "is not usable TOML: nested too deeply", "mend its brackets")
        raise InputError(path, fault) from error
    except ValueError as error:  # a number of thousands of digits
        raise InputError(path, Fault("", "", *_TOO_LARGE)) from error
    _check_measure(path, values)
    return values


def _check_measure(where: object, values: dict[str, Any]) -> None:
    """Refuse what is nested deeper than any study, and whole numbers beyond TOML's 64 bits."""
    levels: list[tuple[str, Any]] = [*values.items()]
    for _ in range(_DEEPEST):
        below: list[tuple[str, Any]] = []
        for key, value in levels:
            if isinstance(value, dict):
                below += [(f"{key}.{name}", inner) for name, inner in value.items()]
            elif isinstance(value, list):
                below += [(key, inner) for inner in value]
            elif isinstance(value, int) and not -(2**63) <= value < 2**63:
                raise InputError(where, Fault(key, "", *_TOO_LARGE))
        levels = below
        if not levels:
            return
    raise InputError(where, Fault(levels[0][0], "", "is nested too deeply", "mend its brackets"))


def faults_of(error: ValidationError, model: type[BaseModel], remedy: str = _ADD_IT) -> list[Fault]:
    """Return each error of a validation as a fault in the user's words.

    The ``remedy`` says what to do about a key that is missing.
    """
    details: dict[str, ErrorDetails] = {}
    for detail in error.errors(include_url=False):
        details.setdefault(_key(detail["loc"]), detail)
    faults = [
        _fault(key, detail, model, remedy) for key, detail in [*details.items()][:_MOST_FAULTS]
    ]
    if len(faults) < len(details):
        rule = f"has {len(details)} faults, of which these are the first"
        return [Fault("", "", rule, "mend them first"), *faults]
    return faults


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
    value = "" if isinstance(detail["input"], dict) else _BRIEF.repr(detail["input"])
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
    known = [*(_OF_A_FILE if model is Study else ()), *model.model_fields]
    close = difflib.get_close_matches(last, known, n=1)
    if close:
        return f"did you mean `{close[0]}`?"
    return f"known here: {', '.join(known)}"


def _key_and_value(override: str) -> tuple[list[str], Any]:
    """Return the parts of an override's key, and its value."""
    parts, text = _parts_and_text(override)
    if text is None or not all(parts):
        fault = Fault("", repr(override), "is not key=value", 'write --set "load.force=5 kN"')
        raise InputError("--set", fault)
    if override.encode(errors="replace").decode() != override:
        raise InputError("--set", Fault("", ascii(override), "is not UTF-8", "write it anew"))
    key = ".".join(parts)
    try:
        parsed = tomllib.loads(f"value = {text}")
    except RecursionError as error:
        fault = Fault(key, "", "is nested too deeply", "mend its brackets")
        raise InputError("--set", fault) from error
    except tomllib.TOMLDecodeError:
        parsed = {"value": text.strip()}  # a bare quantity: "controller.sampling_period=12 ms"
    except ValueError as error:  # a number of thousands of digits
        raise InputError("--set", Fault(key, "", *_TOO_LARGE)) from error
    if len(parts) > _DEEPEST:
        fault = Fault(key, "", "is nested too deeply", "shorten it")
        raise InputError("--set", fault)
    _check_measure("--set", parsed)
    if set(parsed) != {"value"}:
        fault = Fault(key, "", "is given more than one value", "repeat --set for each key")
        raise InputError("--set", fault)
    if parts[0] in _OF_A_FILE:
        fault = Fault(key, "", "belongs to a file", "write it at the top of the study")
        raise InputError("--set", fault)
    return parts, parsed["value"]


def _parts_and_text(override: str) -> tuple[list[str], str | None]:
    """Return the parts of a key and what stands behind its ``=``; None where there is none.

    A part with a point in it, or another sign of TOML's, is quoted as there.
    """
    parts: list[str] = []
    place = 0
    while match := _PART.match(override, place):
        quoted, bare, sign = match.groups()
        if quoted is not None:
            with contextlib.suppress(tomllib.TOMLDecodeError):
                quoted = tomllib.loads(f"part = {quoted}")["part"]
        parts.append(bare.strip() if quoted is None else quoted)
        place = match.end()
        if sign != ".":
            break
    return parts, override[place:] if sign else None
