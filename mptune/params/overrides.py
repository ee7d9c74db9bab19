"""The ``key=value`` texts of the command line, which replace values of a study's files."""

from __future__ import annotations

import contextlib
import re
import tomllib
from typing import Any

from mptune.errors import Fault, InputError
from mptune.params.format import OF_A_FILE
from mptune.params.toml_text import DEEPEST, TOO_LARGE, check_measure

_PART = re.compile(r'\s*(?:("(?:[^"\\]|\\.)*")\s*|([^.=]*))([.=]|\Z)', re.DOTALL)  # of a key


def key_and_value(override: str) -> tuple[list[str], Any]:
    """Return the parts of an override's key, and its value.

    Raises
    ------
    InputError
        If the text is no ``key=value``, or sets what belongs to a file.
    """
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
        raise InputError("--set", Fault(key, "", *TOO_LARGE)) from error
    if len(parts) > DEEPEST:
        fault = Fault(key, "", "is nested too deeply", "shorten it")
        raise InputError("--set", fault)
    check_measure("--set", parsed)
    if set(parsed) != {"value"}:
        fault = Fault(key, "", "is given more than one value", "repeat --set for each key")
        raise InputError("--set", fault)
    if parts[0] in OF_A_FILE:
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
