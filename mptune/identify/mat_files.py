"""Channels of MAT files.

Of version 7.3, which is HDF5, the names are visited once, and only what is asked for is read. Older
files are read whole, for their structures have no names before they are unpacked; how much they
unpack to is found beforehand.
"""

from __future__ import annotations

import struct
import zlib
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from mptune.errors import Fault, InputError
from mptune.hdf5 import stored_arrays
from mptune.identify.channel import Channel, Channels, check_size, unreadable
from mptune.identify.mat_elements import check_elements

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path
    from typing import BinaryIO

_KIND: Final = "MAT file"
_DEEPEST: Final = 8  # structures within structures
_LARGEST: Final = 1_000_000_000  # bytes, unpacked
_HEADER, _TAG = 128, 8  # bytes of version 5
_COMPRESSED: Final = 15  # its type of a packed variable
_PIECE: Final = 1 << 20


def mat_channels(path: Path) -> Channels:
    """Return the vectors of numbers of a MAT file by their dotted names.

    Raises
    ------
    InputError
        If the file is cut off, leads to other files, or holds more than any record.
    """
    import h5py

    try:
        return _version_73(path) if h5py.is_hdf5(path) else _version_5(path)
    except InputError:
        raise
    except Exception as error:  # cut-off files break these readers in many ways
        raise unreadable(path, _KIND, error) from error


def _version_73(path: Path) -> Channels:
    import h5py

    with h5py.File(path, "r") as file:
        stored = stored_arrays(path, file)
    names = [name for name, one in stored.items() if _is_vector(one.shape) and one.is_number]

    def read(name: str) -> Channel:
        check_size(path, name, stored[name].size)
        try:
            with h5py.File(path, "r") as file:
                values = file[stored[name].place][()]
        except Exception as error:  # as above
            raise unreadable(path, _KIND, error) from error
        return Channel(np.squeeze(values).astype(np.float64), "", None)

    return Channels(tuple(names), read)


def _version_5(path: Path) -> Channels:
    from scipy.io import loadmat

    with path.open("rb") as stream:
        _check_unpacked(path, stream)
    check_elements(path.read_bytes())
    channels: dict[str, Channel] = {}
    values = loadmat(path, simplify_cells=True)
    _collect(channels, "", {key: one for key, one in values.items() if key[:2] != "__"}, 0)
    return Channels(tuple(channels), channels.__getitem__)


def _check_unpacked(path: Path, stream: BinaryIO) -> None:
    """Refuse a file of version 5 whose packed variables are more than any record's."""
    header = stream.read(_HEADER)
    order = {b"IM": "<", b"MI": ">"}.get(header[-2:])
    total = 0
    while order and len(tag := stream.read(_TAG)) == _TAG and total <= _LARGEST:
        kind, length = struct.unpack(f"{order}II", tag)
        total += _unpacked(stream, length, _LARGEST - total) if kind == _COMPRESSED else length
        if kind != _COMPRESSED:
            stream.seek(length, 1)
    if max(total, path.stat().st_size) > _LARGEST:
        rule = f"unpacks to more than {_LARGEST / 1e9:g} GB"
        raise InputError(path, Fault("", "", rule, "save the channels that are needed alone"))


def _unpacked(stream: BinaryIO, length: int, most: int) -> int:
    """Return how many bytes a packed variable unpacks to; none of them are kept."""
    unpacking, total = zlib.decompressobj(), 0
    while length > 0 and total <= most:
        piece = stream.read(min(length, _PIECE))
        if not piece:
            break
        length -= len(piece)
        while piece and total <= most:
            total += len(unpacking.decompress(piece, _PIECE))
            piece = unpacking.unconsumed_tail
    return total


def _collect(
    channels: dict[str, Channel], prefix: str, values: Mapping[str, Any], depth: int
) -> None:
    """Note every vector of numbers under its dotted name."""
    for key, value in values.items():
        name = f"{prefix}{key}"
        if isinstance(value, dict):
            if depth < _DEEPEST:
                _collect(channels, f"{name}.", value, depth + 1)
        elif (
            isinstance(value, np.ndarray) and value.dtype.kind in "fiu" and _is_vector(value.shape)
        ):
            channels[name] = Channel(np.squeeze(value).astype(np.float64), "", None)


def _is_vector(shape: tuple[int, ...]) -> bool:
    return sum(length != 1 for length in shape) == 1 and 0 not in shape
