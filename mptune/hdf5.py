"""HDF5 files that are not one's own: names without values, each object once, nothing from outside.

An HDF5 file can name bytes of other files as its own (external storage, external links, virtual
data sets), lead in circles by links, and declare arrays beyond any memory. What leads outside is
refused, links that are no objects of the file are passed over, and nothing is read here.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

from mptune.errors import Fault, InputError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    import h5py

_MOST_OBJECTS: Final = 20_000
_DEEPEST: Final = 8  # groups within groups
_OUTSIDE: Final = "reads bytes of another file, and nothing outside a file is read"


class Stored(NamedTuple):
    """A data set in a file."""

    place: str  # its path in the file
    shape: tuple[int, ...]
    item_size: int  # bytes
    is_number: bool

    @property
    def size(self) -> int:
        """Its values."""
        return math.prod(self.shape)


def stored_arrays(path: Path, file: h5py.File, separator: str = ".") -> dict[str, Stored]:
    """Return the data sets of a file by their names, in order; groups named ``#…`` are left out.

    Raises
    ------
    InputError
        If a data set or a link leads to another file, or there are more objects than any record
        has.
    """
    import h5py

    found: dict[str, Stored] = {}
    for name, one in _objects(path, file, separator):
        if isinstance(one, h5py.Dataset):
            if one.is_virtual or one.external:
                raise InputError(path, Fault(name, "", _OUTSIDE, "copy the values into the file"))
            number = one.dtype.kind in "fiu"
            found[name] = Stored(str(one.name), one.shape or (), one.dtype.itemsize, number)
    return found


def check_total(path: Path, stored: Mapping[str, Stored], most: int) -> None:
    """Refuse a file whose arrays together take more than ``most`` bytes, before any is read.

    Raises
    ------
    InputError
        With what they would take.
    """
    size = sum(one.size * one.item_size for one in stored.values())
    if size > most:
        rule = f"holds {size / 1e9:.3g} GB, {most / 1e9:g} GB at most are read"
        raise InputError(path, Fault("", "", rule, "make it again, or take a smaller one"))


def _objects(
    path: Path, file: h5py.File, separator: str
) -> Iterator[tuple[str, h5py.Group | h5py.Dataset]]:
    """Yield each object that hard links lead to, once, with its first name."""
    import h5py

    seen = {_address(file)}
    waiting: list[tuple[str, h5py.Group, int]] = [("", file, 0)]
    while waiting:
        prefix, group, depth = waiting.pop()
        inner = []
        for key in group:
            link = group.get(key, getlink=True)
            name = f"{prefix}{key}"
            if isinstance(link, h5py.ExternalLink):
                raise InputError(path, Fault(name, "", _OUTSIDE, "copy the values into the file"))
            if not isinstance(link, h5py.HardLink) or key.startswith("#"):
                continue
            one = group[key]
            if _address(one) in seen:
                continue
            seen.add(_address(one))
            if len(seen) > _MOST_OBJECTS:
                rule = f"holds more than {_MOST_OBJECTS} objects"
                raise InputError(path, Fault("", "", rule, "export the channels needed alone"))
            yield name, one
            if isinstance(one, h5py.Group) and depth < _DEEPEST:
                inner.append((f"{name}{separator}", one, depth + 1))
        waiting += reversed(inner)


def _address(one: h5py.Group | h5py.Dataset) -> int:
    """Return where an object stands in its file: two names of one thing share it."""
    import h5py

    return int(h5py.h5o.get_info(one.id).addr)
