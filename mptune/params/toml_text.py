"""TOML that may come from anybody; what is larger or deeper than any study is refused."""

from __future__ import annotations

import tomllib
from typing import TYPE_CHECKING, Any

from mptune.errors import Fault, InputError

if TYPE_CHECKING:
    from pathlib import Path

DEEPEST = 16  # tables and lists within one another; studies have 5
TOO_LARGE = "is a whole number beyond 64 bits", "write a smaller one, or one with a point"
_LARGEST = 10_000_000  # characters of TOML, which take seconds to read
_WHOLE = "name a study or a gains file, which have some thousands"


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
        raise InputError(path, Fault("", "", *TOO_LARGE)) from error
    check_measure(path, values)
    return values


def check_measure(where: object, values: dict[str, Any]) -> None:
    """Refuse what is nested deeper than any study, and whole numbers beyond TOML's 64 bits.

    Raises
    ------
    InputError
        Naming the key.
    """
    levels: list[tuple[str, Any]] = [*values.items()]
    for _ in range(DEEPEST):
        below: list[tuple[str, Any]] = []
        for key, value in levels:
            if isinstance(value, dict):
                below += [(f"{key}.{name}", inner) for name, inner in value.items()]
            elif isinstance(value, list):
                below += [(key, inner) for inner in value]
            elif isinstance(value, int) and not -(2**63) <= value < 2**63:
                raise InputError(where, Fault(key, "", *TOO_LARGE))
        levels = below
        if not levels:
            return
    raise InputError(where, Fault(levels[0][0], "", "is nested too deeply", "mend its brackets"))
