"""Outer loops, filters and estimator as IEC 61131-3 Structured Text: fixed blocks, constants.

The blocks hold all that makes F_ref; the decision on valve states is for C or a mock-up unit.

The whole of a text compiles as it stands with compilers that keep to the standard's letter, matiec
and with it OpenPLC: constants are global to a configuration, and every block that uses one says so
(``VAR_EXTERNAL``). Environments with lists of global variables of their own, CODESYS and TwinCAT,
take the same blocks; there the constants go into such a list, and the configuration is left out.
"""

from __future__ import annotations

import re
from decimal import Decimal
from importlib import resources
from typing import TYPE_CHECKING

import numpy as np

from mptune.escaping import comment_text
from mptune.export.formats import Precision

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mptune.export.constants import Number, Numbers
    from mptune.export.controller import TargetController

_TITLE = (
    "Outer loops, filters and state estimator of a multi-pressure hydraulic cylinder, written by "
    "mptune. "
    "MPT_Measurement runs every T_S,fast, MPT_OuterLoops every T_S; MPT_Program does both in a "
    "task of T_S,fast. Where global variables have a list of their own, move the constants there "
    "and leave out the configuration."
)
_SECTIONS = ("outer_loops", "feedforward_lags", "state_estimator", "filters")
_ALSO = ("area_a", "area_b")  # of the force controller's
_FILES = ("estimator.st", "outer_loops.st", "program.st")
_UNIT = re.compile(r"^(FUNCTION_BLOCK|PROGRAM) .*?^END_\1$", re.MULTILINE | re.DOTALL)
_COMMENT = re.compile(r"\(\*.*?\*\)", re.DOTALL)
_DECLARED = "END_VAR\n"
_TICKS = ("MPT_TICKS", "DINT")


def structured_text(controller: TargetController) -> str:
    """Return blocks, program and configuration; REAL where the precision is single."""
    numbers = controller.numbers
    folder = resources.files("mptune.export").joinpath("st")
    blocks = "\n".join(folder.joinpath(name).read_text("utf-8") for name in _FILES)
    kinds = dict([*((f"MPT_{one.key.upper()}", "LREAL") for one in _held(numbers)), _TICKS])
    parts = (
        _comment(controller.heading(_TITLE)),
        _UNIT.sub(lambda unit: _with_externals(unit[0], kinds), blocks),
        _configuration(numbers),
    )
    text = "\n".join(parts)
    if numbers.precision is Precision.FLOAT:
        return text.replace("LREAL", "REAL")
    return text


def _held(numbers: Numbers) -> list[Number]:
    """Return the numbers that the blocks run with."""
    held = [one for section in _SECTIONS for one in numbers.sections[section]]
    return held + [one for one in numbers.sections["force_controller"] if one.key in _ALSO]


def _with_externals(unit: str, kinds: dict[str, str]) -> str:
    """Return a block or program that declares each global constant in its body as external."""
    declarations, _, body = unit.rpartition(_DECLARED)
    words = set(re.findall(r"\w+", _COMMENT.sub("", body)))
    used = [f"    {name} : {kind};\n" for name, kind in kinds.items() if name in words]
    external = f"VAR_EXTERNAL CONSTANT\n{''.join(used)}{_DECLARED}" if used else ""
    return f"{declarations}{_DECLARED}{external}{body}"


def _configuration(numbers: Numbers) -> str:
    """Return the constants, and a task of T_S,fast with the program."""
    single = numbers.precision is Precision.FLOAT
    constants = [
        f"MPT_{one.key.upper()} : LREAL := {_literal(one.value, single=single)}; "
        f"(* {one.unit if one.unit != '1' else '-'}, {one.meaning} *)"
        for one in _held(numbers)
    ]
    name, kind = _TICKS
    constants.append(f"{name} : {kind} := {numbers.ticks}; (* -, T_S in T_S,fast *)")
    interval = _milliseconds(numbers.value("sample_time"))
    lines = [
        "CONFIGURATION MPT_Configuration",
        "    VAR_GLOBAL CONSTANT",
        *(f"        {one}" for one in constants),
        "    END_VAR",
        "    RESOURCE MPT_Resource ON PLC",
        f"        TASK MPT_Fast(INTERVAL := T#{interval}ms, PRIORITY := 0);",
        "        PROGRAM MPT_Instance WITH MPT_Fast : MPT_Program;",
        "    END_RESOURCE",
        "END_CONFIGURATION",
    ]
    return "\n".join([*lines, ""])


def _milliseconds(seconds: float) -> str:
    """Return a time of the standard, which knows no exponents, to the nanosecond."""
    text = f"{Decimal(repr(seconds)) * 1000:.6f}"
    return text.rstrip("0").rstrip(".")


def _literal(value: float, *, single: bool) -> str:
    """Return a literal of the standard, which asks for digits on both sides of the point."""
    mantissa, separator, exponent = (str(np.float32(value)) if single else repr(value)).partition(
        "e"
    )
    point = "" if "." in mantissa else ".0"
    return mantissa + point + (f"E{int(exponent)}" if separator else "")


def _comment(lines: Iterable[str]) -> str:
    safe = map(comment_text, lines)
    return "(*\n" + "".join(f"   {line}".rstrip() + "\n" for line in safe) + "*)\n"
