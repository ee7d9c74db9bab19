"""What can be exported: formats, and the arithmetic of the target."""

from __future__ import annotations

from enum import StrEnum


class Target(StrEnum):
    """Formats of the controller's files."""

    TOML = "toml"
    JSON = "json"
    C = "c"  # C99
    FMU = "fmu"  # FMI 2.0 and 3.0, co-simulation
    ST = "st"  # IEC 61131-3, all that makes F_ref


class Precision(StrEnum):
    """Arithmetic of the target."""

    DOUBLE = "double"
    FLOAT = "float"
