"""The channels of a data file, whatever its format: names first, values when asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.errors import Fault, InputError
from mptune.identify.channel import Channel, Channels
from mptune.identify.mat_files import mat_channels
from mptune.identify.mdf_files import mdf_channels
from mptune.params.table import read_table

if TYPE_CHECKING:
    from pathlib import Path

_HEADING = "time [s],F_ref [kN],F [kN]"


def read_channels(path: Path) -> Channels:
    """Return the channels of a CSV, MAT or MDF4 file, told apart by the end of its name.

    Raises
    ------
    InputError
        If the file is missing, cut off or of no known format.
    """
    readers = {
        ".csv": _csv,
        ".txt": _csv,
        ".mat": mat_channels,
        ".mf4": mdf_channels,
        ".mdf": mdf_channels,
    }
    reader = readers.get(path.suffix.lower())
    if reader is None:
        rule = f"is no kind of file that is read here ({path.suffix or 'no ending'})"
        raise InputError(path, Fault("", "", rule, f"give one of {', '.join(readers)}"))
    if not path.is_file():
        rule = "is a folder, not a file" if path.is_dir() else "does not exist"
        raise InputError(path, Fault("", "", rule, "check the path"))
    if path.stat().st_size == 0:
        raise InputError(path, Fault("", "", "is empty", "record or copy it again"))
    return reader(path)


def _csv(path: Path) -> Channels:
    table = read_table(path, _HEADING)
    channels = {
        label: Channel(column, unit, None)
        for label, unit, column in zip(table.labels, table.units, table.columns, strict=True)
    }
    return Channels(tuple(channels), channels.__getitem__)
