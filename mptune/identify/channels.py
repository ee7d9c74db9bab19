"""The channels of a data file, whatever its format: names first, values when asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from mptune.errors import Fault, InputError
from mptune.params.table import read_table

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from mptune.arrays import FloatArray

_FORMULA = 3  # MDF4's conversion by an algebraic formula
_DEEPEST = 8  # structures within structures
_HEADING = "time [s],F_ref [kN],F [kN]"


class Channel(NamedTuple):
    """One channel: its values as recorded, their unit (empty where the file has none), its time."""

    values: FloatArray  # (T,)
    unit: str
    time: FloatArray | None  # (T,) s, where the format knows it


class Channels(NamedTuple):
    """A file's channels by name."""

    names: tuple[str, ...]
    read: Callable[[str], Channel]


def read_channels(path: Path) -> Channels:
    """Return the channels of a CSV, MAT or MDF4 file, told apart by the end of its name.

    Raises
    ------
    InputError
        If the file is missing, cut off or of no known format.
    """
    readers = {".csv": _csv, ".txt": _csv, ".mat": _mat, ".mf4": _mdf, ".mdf": _mdf}
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


def _mat(path: Path) -> Channels:
    import h5py
    from scipy.io import loadmat

    channels: dict[str, Channel] = {}
    try:
        if h5py.is_hdf5(path):  # version 7.3
            with h5py.File(path, "r") as file:
                _collect(channels, "", {key: file[key] for key in file}, 0)
        else:
            values = loadmat(path, simplify_cells=True)
            _collect(channels, "", {k: v for k, v in values.items() if k[:2] != "__"}, 0)
    except Exception as error:  # cut-off files break these readers in many ways
        raise _unreadable(path, "MAT file", error) from error
    return Channels(tuple(channels), channels.__getitem__)


def _collect(channels: dict[str, Channel], prefix: str, values: Any, depth: int) -> None:
    """Note every vector of numbers under its dotted name."""
    import h5py

    for key in values:
        value, name = values[key], f"{prefix}{key}"
        if isinstance(value, dict | h5py.Group):
            if depth < _DEEPEST and not str(key).startswith("#"):
                _collect(channels, f"{name}.", value, depth + 1)
            continue
        if isinstance(value, h5py.Dataset):
            value = value[()] if value.dtype.kind in "fiu" else None
        if isinstance(value, np.ndarray) and value.dtype.kind in "fiu":
            vector = np.squeeze(value).astype(np.float64)
            if vector.ndim == 1 and vector.size > 1:
                channels[name] = Channel(vector, "", None)


def _mdf(path: Path) -> Channels:
    try:
        from asammdf import MDF
    except ImportError as error:
        fault = Fault("", "", "needs asammdf", 'install it with: pip install "mptune[data]"')
        raise InputError(path, fault) from error
    try:
        with MDF(path) as file:
            names = tuple(sorted(file.channels_db))
    except Exception as error:  # cut-off files break the reader in many ways
        raise _unreadable(path, "MDF file", error) from error

    def read(name: str) -> Channel:
        try:
            with MDF(path) as file:
                group, index = file.channels_db[name][0]
                signal = file.get(name, group=group, index=index, raw=True)
        except Exception as error:  # as above
            raise _unreadable(path, "MDF file", error) from error
        if getattr(signal.conversion, "conversion_type", 0) == _FORMULA:
            rule = "is scaled by a formula, and nothing from a file is evaluated"
            remedy = "export the channel with its physical values"
            raise InputError(path, Fault(name, "", rule, remedy))
        signal = signal.physical()
        if signal.samples.ndim != 1 or signal.samples.dtype.kind not in "fiu":
            raise InputError(path, Fault(name, "", "holds no numbers", "name another channel"))
        values = signal.samples.astype(np.float64)
        return Channel(values, signal.unit or "", np.asarray(signal.timestamps))

    return Channels(names, read)


def _unreadable(path: Path, kind: str, error: Exception) -> InputError:
    rule = f"is no whole {kind} ({type(error).__name__}: {str(error)[:80]})"
    return InputError(path, Fault("", "", rule, "record or copy it again"))
