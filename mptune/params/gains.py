"""Gains files: the gains in SI, the study they belong to, and what is known of them.

``gains.toml`` is what the bundled controller reads. It refuses a file whose margins are not
satisfied, unless told otherwise, and one that belongs to another model.
"""

from __future__ import annotations

import datetime as dt
import hashlib
import importlib.metadata
import json
from pathlib import Path
from typing import Any, Literal

import tomlkit
from pydantic import Field, ValidationError

from mptune.errors import Fault, InputError
from mptune.files import read_text, write_whole
from mptune.params.controller import Feedforward, Gains
from mptune.params.format import FORMAT_KEY, GAINS_FORMAT
from mptune.params.load import faults_of, parse_toml
from mptune.params.section import Section
from mptune.summary import Summarised

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
    margins: Verdict = Field(description="verdict on the requirements of Eq. 17 and 21 and others")
    closed_loop: Verdict = Field(description="verdict on the closed loop in time")
    gains: Gains
    feedforward: Feedforward
    figures: dict[str, dict[str, Any]]

    @property
    def headline(self) -> str:
        """Study and verdicts."""
        return f"Gains of {self.study}: margins {self.margins}, closed loop {self.closed_loop}"

    def content_hash(self) -> str:
        """Return the hash of all that the file says; it stands in the file as well."""
        return _hash(self.model_dump())


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
    values = gains.model_dump() | {"content_hash": gains.content_hash()}
    for key, value in values.items():
        if not isinstance(value, dict):
            document.add(key, value)
    for section in (gains.gains, gains.feedforward):
        name = type(section).__name__.lower()
        table = tomlkit.table()
        for key, unit, symbol, meaning in section.quantities():
            item = tomlkit.item(getattr(section, key))
            item.comment(f"{unit if unit != '1' else '-'}, {symbol}, {meaning}")
            table.add(key, item)
        for key in type(section).model_fields:
            if key not in table:
                table.add(key, getattr(section, key))  # a switch
        document.add(name, table)
    document.add("figures", values["figures"])
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


def accepted_gains(path: str | Path, study_hash: str, *, force: bool = False) -> GainsFile:
    """Read a gains file as a controller does: with satisfied margins, or on insistence.

    Raises
    ------
    InputError
        As ``read_gains``, and where the margins are not satisfied and ``force`` is False.
    """
    gains = read_gains(path, study_hash)
    if gains.margins != "satisfied" and not force:
        fault = Fault(
            "margins",
            gains.margins,
            "is no verdict that the controller accepts",
            "tune again, or insist with --force",
        )
        raise InputError(path, fault)
    return gains
