"""Gains files: the gains in SI, the study they belong to, and what is known of them.

``gains.toml`` is what the bundled controller reads. It refuses a file whose margins are not
satisfied, unless told otherwise. What a tuner may choose stands in it, a table for each section of
``CHOSEN``, and takes the place of what the study says. To judge the same controller elsewhere is
allowed: what differs from the model that it was made for is said.
"""

from __future__ import annotations

import datetime as dt
import hashlib
import importlib.metadata
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import tomlkit
from pydantic import Field, ValidationError

from mptune.errors import Fault, InputError
from mptune.files import read_text, write_whole
from mptune.params.controller import Feedforward, Gains
from mptune.params.estimator import Estimator
from mptune.params.format import FORMAT_KEY, GAINS_FORMAT
from mptune.params.headline import Headline
from mptune.params.judged_on import Difference, differences, refuse_other_controller
from mptune.params.load import faults_of
from mptune.params.section import Section
from mptune.params.study import CHOSEN
from mptune.params.toml_text import parse_toml
from mptune.summary import Summarised

if TYPE_CHECKING:
    from mptune.params.study import ResolvedStudy

_MISSING_FILE = "check the path, or let `mptune tune STUDY` write it"
_MISSING_KEY = "tune or export it again"  # nobody writes a gains file by hand

Verdict = Literal["satisfied", "violated", "not run"]


def version() -> str:
    """Return mptune's version."""
    return importlib.metadata.version("mptune")


class GainsFile(Summarised, Section):
    """What a gains file says."""

    study: str = Field(description="name of the study")
    study_hash: str = Field(description="hash of the study's SI model", pattern="^[0-9a-f]{64}$")
    uncertainty: str = Field("", description="name of the uncertainty set; empty for the default")
    version: str = Field(description="version of mptune that wrote the file")
    date: str = Field(description="when it was written, UTC")
    verdict: Headline | Literal[""] = Field(
        "", description="how the gains came out; empty in files that do not say"
    )
    reason: str = Field("", description="what that verdict rests on")
    margins: Verdict = Field(description="satisfied where the verdict is met, else violated")
    closed_loop: Verdict = Field(description="verdict on the closed loop in time")
    gains: Gains
    feedforward: Feedforward
    estimator: Estimator | None = Field(
        None, description="what measures; None in files of before there was a choice"
    )
    figures: dict[str, dict[str, Any]]
    judged_on: dict[str, Any] = Field(
        default_factory=dict, description="the SI model that the verdicts hold for, by dotted key"
    )

    @property
    def headline(self) -> str:
        """Study and verdicts."""
        return f"Gains of {self.study}: {self.verdicts}"

    @property
    def verdicts(self) -> str:
        """All that the file says of how the gains came out."""
        stated = f"{self.verdict}; " if self.verdict else ""
        return f"{stated}margins {self.margins}, closed loop {self.closed_loop}"

    @property
    def chosen(self) -> dict[str, Section]:
        """The sections that a tuner may choose, by name; those that the file holds."""
        sections = {name: getattr(self, name) for name in CHOSEN}
        return {name: section for name, section in sections.items() if section is not None}

    def put_over(self, study: ResolvedStudy) -> ResolvedStudy:
        """Return a study with what this file says in the place of its own."""
        return study.model_copy(update={"study": study.study.model_copy(update=self.chosen)})

    def content_hash(self) -> str:
        """Return the hash of all that the file says; it stands in the file as well."""
        return _hash(self.model_dump(exclude_none=True))


def _hash(values: dict[str, Any]) -> str:
    text = json.dumps(values, sort_keys=True, default=str)  # a file may hold a date as well
    return hashlib.sha256(text.encode()).hexdigest()


def now() -> str:
    """Return the present time, UTC, to the second."""
    return dt.datetime.now(dt.UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def write_gains(path: str | Path, gains: GainsFile) -> Path:
    """Write a gains file, whole or not at all.

    Parameters
    ----------
    path
        The file to write.
    gains
        What it is to say.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    document = tomlkit.document()
    document.add(tomlkit.comment("Gains in SI units, written by mptune. Do not edit: the margins"))
    document.add(tomlkit.comment("below hold for exactly these numbers."))
    document.add(FORMAT_KEY, GAINS_FORMAT.newest)
    values = gains.model_dump(exclude_none=True) | {"content_hash": gains.content_hash()}
    for key, value in values.items():
        if not isinstance(value, dict):
            document.add(key, str(value))  # a verdict is a word of its own kind
    for name, section in gains.chosen.items():
        table = tomlkit.table()
        for key, unit, symbol, meaning in section.quantities():
            if getattr(section, key) is None:
                continue
            item = tomlkit.item(getattr(section, key))
            item.comment(f"{unit if unit != '1' else '-'}, {symbol}, {meaning}")
            table.add(key, item)
        for key in type(section).model_fields:
            if key not in table and getattr(section, key) is not None:
                table.add(key, getattr(section, key))  # a switch, or a word
        document.add(name, table)
    for key in ("figures", "judged_on"):
        document.add(key, values[key])
    return write_whole(path, tomlkit.dumps(document))


def read_gains(path: str | Path, study_hash: str = "") -> GainsFile:
    """Read a gains file.

    Parameters
    ----------
    path
        The file.
    study_hash
        The hash of the study for which the gains are wanted; empty where any will do.

    Raises
    ------
    InputError
        If the file cannot be read, is of a newer format, breaks a rule, was edited, or belongs to
        another study.
    """
    path = Path(path)
    values = parse_toml(path, read_text(path, _MISSING_FILE))
    GAINS_FORMAT.take(path, values)
    stated = values.pop("content_hash", "")
    try:
        gains = GainsFile.model_validate(values, context={"si": True})
    except ValidationError as error:
        raise InputError(path, *faults_of(error, GainsFile, _MISSING_KEY)) from error
    if stated != _hash(values):  # as written: keys that later versions add are not in it
        fault = Fault(
            "content_hash",
            "",
            "does not fit the rest of the file, which was edited or cut off",
            "tune or export it again",
        )
        raise InputError(path, fault)
    if study_hash and gains.study_hash != study_hash:
        fault = Fault(
            "study_hash",
            f"{gains.study_hash[:12]}…",
            f"belongs to another model than this study's ({study_hash[:12]}…)",
            "tune or sweep with the study and uncertainty set that the gains were made for",
        )
        raise InputError(path, fault)
    return gains


def gains_for(study: ResolvedStudy, path: str | Path) -> tuple[GainsFile, tuple[Difference, ...]]:
    """Read a gains file to judge it on a study, with what differs from the model it was made for.

    Parameters
    ----------
    study
        The study: the same controller, on any grid, set, box or machine.
    path
        The file.

    Raises
    ------
    InputError
        As ``read_gains``; where the controllers differ, or an early file does not say what it was
        made for and the model is another.
    """
    file = read_gains(path)
    if file.study_hash == study.hash():
        return file, ()
    if not file.judged_on:
        read_gains(path, study.hash())  # refuses it
    found = differences(file.judged_on, study)
    refuse_other_controller(path, found)
    return file, found


def accept_margins(path: str | Path, gains: GainsFile, *, force: bool = False) -> None:
    """Refuse gains as a controller does: where their margins are not satisfied, unless told.

    Raises
    ------
    InputError
        If the margins are not satisfied and ``force`` is False.
    """
    if gains.margins != "satisfied" and not force:
        said = f" ({gains.verdict}: {gains.reason})" if gains.verdict else ""
        fault = Fault(
            "margins",
            gains.margins,
            f"is no verdict that the controller accepts{said}",
            "tune again, or insist with --force",
        )
        raise InputError(path, fault)


def accepted_gains(
    study: ResolvedStudy, path: str | Path, *, force: bool = False
) -> tuple[GainsFile, tuple[Difference, ...]]:
    """Read a gains file as a controller does: with satisfied margins unless told.

    Returns
    -------
    tuple
        The file, and what differs from the model that it was made for.

    Raises
    ------
    InputError
        As ``gains_for``, and where the margins are not satisfied and ``force`` is False.
    """
    gains, differs = gains_for(study, path)
    accept_margins(path, gains, force=force)
    return gains, differs
