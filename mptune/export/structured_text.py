"""Outer loops and filters as IEC 61131-3 Structured Text: fixed blocks, the study's constants."""

from __future__ import annotations

from importlib import resources
from typing import TYPE_CHECKING

import numpy as np

from mptune.errors import Fault, InputError
from mptune.export.formats import Precision

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mptune.export.controller import TargetController

_TITLE = (
    "Outer loops and filters of a multi-pressure hydraulic cylinder, written by mptune. "
    "MPT_Measurement runs every T_S,fast, MPT_OuterLoops every T_S."
)
_SECTIONS = ("outer_loops", "feedforward_lags", "state_estimator", "filters")


def structured_text(controller: TargetController) -> str:
    """Return the function blocks and their constants; REAL where the precision is single.

    Raises
    ------
    InputError
        If the study has what the blocks do not hold: a state estimator, friction fed forward or a
        mass that is learnt on line.
    """
    _check_held(controller)
    blocks = resources.files("mptune.export").joinpath("st/outer_loops.st").read_text("utf-8")
    text = _comment(controller.heading(_TITLE)) + _constants(controller) + "\n" + blocks
    if controller.numbers.precision is Precision.FLOAT:
        return text.replace("LREAL", "REAL")
    return text


def _check_held(controller: TargetController) -> None:
    for key in ("estimator_mass", "adaptive", "viscous_friction", "coulomb_friction"):
        value = controller.numbers.value(key)
        if value != 0:
            raise InputError(
                controller.study.name,
                Fault(
                    key,
                    f"{value:g}",
                    "is nothing that the Structured Text blocks hold",
                    "export to C or as a function mock-up unit instead",
                ),
            )


def _constants(controller: TargetController) -> str:
    numbers = controller.numbers
    lines = ["VAR_GLOBAL CONSTANT"]
    for section in _SECTIONS:
        for one in numbers.sections[section]:
            unit = one.unit if one.unit != "1" else "-"
            value = _literal(one.value, single=numbers.precision is Precision.FLOAT)
            lines.append(
                f"    MPT_{one.key.upper()} : LREAL := {value}; (* {unit}, {one.meaning} *)"
            )
    return "\n".join([*lines, "END_VAR", ""])


def _literal(value: float, *, single: bool) -> str:
    """Return a literal of the standard, which asks for digits on both sides of the point."""
    mantissa, separator, exponent = (str(np.float32(value)) if single else repr(value)).partition(
        "e"
    )
    point = "" if "." in mantissa else ".0"
    return mantissa + point + (f"E{int(exponent)}" if separator else "")


def _comment(lines: Iterable[str]) -> str:
    safe = (line.replace("*)", "* )").replace("(*", "( *") for line in lines)
    return "(*\n" + "".join(f"   {line}".rstrip() + "\n" for line in safe) + "*)\n"
