"""The controller's numbers as a TOML or a JSON file."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import tomlkit

from mptune.escaping import comment_text, printable_values
from mptune.export.controller import WARNING
from mptune.params.chambers import LETTERS, NUMBERS
from mptune.params.format import CONTROLLER_FORMAT, FORMAT_KEY

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mptune.export.controller import TargetController

_TITLE = (
    "A controller in SI units, written by mptune. Do not edit: the margins hold for it as it is."
)


def as_toml(controller: TargetController) -> str:
    """Return the controller as TOML: a table for each section, unit and meaning in comments."""
    document = tomlkit.document()
    for line in controller.heading(_TITLE):
        document.add(tomlkit.comment(comment_text(line)) if line else tomlkit.nl())
    document.add(FORMAT_KEY, CONTROLLER_FORMAT)
    document.add("provenance", tomlkit.item(printable_values(controller.provenance())))
    document.add("verdict", tomlkit.item(printable_values(_verdict(controller))))
    for name, values in _sections(controller):
        table = tomlkit.table()
        for key, value, unit, meaning in values:
            item = tomlkit.item(value)
            item.comment(f"{unit if unit != '1' else '-'}, {meaning}")
            table.add(key, item)
        document.add(name, table)
    return tomlkit.dumps(document)


def as_json(controller: TargetController) -> str:
    """Return the controller as JSON: each number with value, unit and meaning."""
    values: dict[str, Any] = {"title": _TITLE, FORMAT_KEY: CONTROLLER_FORMAT}
    if not controller.trusted:
        values["warning"] = " ".join(WARNING)
    values |= {"provenance": controller.provenance(), "verdict": _verdict(controller)}
    for name, section in _sections(controller):
        values[name] = {
            key: {"value": value, "unit": unit, "meaning": meaning}
            for key, value, unit, meaning in section
        }
    return (
        json.dumps(printable_values(values), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    )


def _verdict(controller: TargetController) -> dict[str, Any]:
    """Return the verdicts; TOML has no word for what could not be found, so it is left out."""
    requirements = [
        {key: value for key, value in one.items() if value is not None}
        for one in controller.verdicts()
    ]
    return {
        "verdict": controller.word.value,
        "reason": controller.reason,
        "margins": controller.verdict,
        "margins_in_gains_file": controller.source.margins,
        "closed_loop": controller.source.closed_loop,
        "differs": [one.json() for one in controller.differs],
        "forced": not controller.trusted,
        "requirements": requirements,
    }


def _sections(
    controller: TargetController,
) -> Iterator[tuple[str, list[tuple[str, float, str, str]]]]:
    for section in (controller.gains, controller.feedforward):
        yield (
            type(section).__name__.lower(),
            [
                (key, getattr(section, key), unit, f"{symbol}, {meaning}")
                for key, unit, symbol, meaning in section.quantities()
            ],
        )
    sections = dict(controller.numbers.sections)
    if len(controller.numbers.chambers) > NUMBERS[0]:
        chambers = zip(LETTERS.lower(), controller.numbers.chambers, strict=False)
        sections |= {f"chamber_{letter}": numbers for letter, numbers in chambers}
    for name, numbers in sections.items():
        yield name, [(one.key, one.value, one.unit, one.meaning) for one in numbers]
