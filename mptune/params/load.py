"""From a study's files to objects: bases, validation, and errors in the user's words."""

from __future__ import annotations

import difflib
import os
import reprlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ValidationError

from mptune.errors import Fault, InputError
from mptune.escaping import file_name
from mptune.files import read_text
from mptune.params.beside import name_beside
from mptune.params.chambers import missing_of_the_short_form
from mptune.params.coherence import doubts_of, refusals_of
from mptune.params.extent import faults_of_extent
from mptune.params.format import BASE_KEY, OF_A_FILE, STUDY_FORMAT
from mptune.params.layers import Layers
from mptune.params.lines import missing_supplies
from mptune.params.long_form import ADD_IT, long_form, missing
from mptune.params.measured import read_measured
from mptune.params.overrides import key_and_value
from mptune.params.recorded import read_load_table, read_references
from mptune.params.study import ResolvedStudy, Study
from mptune.params.toml_text import parse_toml

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pydantic_core import ErrorDetails

    from mptune.params.uncertainty import UncertaintySet

_REMEDY = "check the path, or start a study with `mptune new NAME`"

_MOST_FAULTS = 8  # of a file, in words; the rest is counted
_MOST_BASES = 30  # of a study, one behind the other; studies have 2
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
        layers.override(*key_and_value(override))
    read_references(layers)
    read_load_table(layers)
    read_measured(layers)
    name_beside(layers)
    absent = missing(missing_of_the_short_form(layers.values))
    try:
        study = Study.model_validate(layers.values)
    except ValidationError as error:
        raise layers.refusal(*faults_of(error, Study), *absent) from error
    study = long_form(study)
    if absent := [*absent, *missing(missing_supplies(study.supplies))]:
        raise layers.refusal(*absent)
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
        base = values.pop(BASE_KEY, None)
        written.insert(0, (path, values))
        if base is None:
            break
        if len(written) > _MOST_BASES:
            rule = f"is one more than {_MOST_BASES} bases, each of the next"
            raise InputError(
                path, Fault(BASE_KEY, repr(base), rule, "write the last ones into one")
            )
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
        fault = Fault(
            BASE_KEY, repr(base), "is no file name", f'write {BASE_KEY} = "../boom/study.toml"'
        )
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
        raise InputError(file, Fault(BASE_KEY, repr(base), rule, remedy)) from error
    if os.path.realpath(path) in map(os.path.realpath, files):
        chain = " → ".join(map(str, (*files, path)))
        fault = Fault(
            BASE_KEY, repr(base), f"closes a cycle: {chain}", "let one stand without a base"
        )
        raise InputError(file, fault)
    return path, text


def faults_of(error: ValidationError, model: type[BaseModel], remedy: str = ADD_IT) -> list[Fault]:
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
    known = [*(OF_A_FILE if model is Study else ()), *model.model_fields]
    close = difflib.get_close_matches(last, known, n=1)
    if close:
        return f"did you mean `{close[0]}`?"
    return f"known here: {', '.join(known)}"
