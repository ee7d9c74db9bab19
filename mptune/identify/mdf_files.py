"""Channels of MDF files, versions 2 to 4, in which nothing from the file is evaluated.

A conversion may be a formula in the file's own words, which the reader hands to an evaluator of
Python's. So only conversions by numbers are let through, of a channel and of its time.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from mptune.errors import Fault, InputError
from mptune.identify.channel import Channel, Channels, check_size, unreadable

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

_KIND: Final = "MDF file"
_BY_NUMBERS_3: Final = frozenset({0, 1, 2, 6, 7, 8, 9, 65535})  # linear, tables, …, rational, none
_BY_NUMBERS_4: Final = frozenset({0, 1, 2, 4, 5, 6})  # none, linear, rational, tables of numbers
_PLAIN_4: Final = frozenset({0, 2, 3, 6})  # value, master, virtual master, virtual
_DEEPEST: Final = 8  # groups whose time is another group's


def mdf_channels(path: Path) -> Channels:
    """Return the channels of an MDF file.

    Raises
    ------
    InputError
        If the file is cut off, or the reader is not installed; of a channel, on reading, if it is
        scaled by more than numbers, or longer than any record.
    """
    try:
        mdf: Any = import_module("asammdf").MDF
    except ImportError as error:
        fault = Fault("", "", "needs asammdf", 'install it with: pip install "mptune[data]"')
        raise InputError(path, fault) from error
    try:
        with mdf(path, process_bus_logging=False) as file:
            places = _places(file.channels_db)
    except Exception as error:  # cut-off files break the reader in many ways
        raise unreadable(path, _KIND, error) from error

    def read(name: str) -> Channel:
        try:
            with mdf(path, process_bus_logging=False) as file:
                group, index = places[name]
                _check(path, name, file, group, index)
                signal = file.get(group=group, index=index)
        except InputError:
            raise
        except Exception as error:  # as above
            raise unreadable(path, _KIND, error) from error
        if signal.samples.ndim != 1 or signal.samples.dtype.kind not in "fiu":
            raise InputError(path, Fault(name, "", "holds no numbers", "name another channel"))
        values = signal.samples.astype(np.float64)
        return Channel(values, signal.unit or "", np.asarray(signal.timestamps, np.float64))

    return Channels(tuple(sorted(places)), read)


def _places(found: Mapping[str, Sequence[tuple[int, int]]]) -> dict[str, tuple[int, int]]:
    """Return group and place of each channel; one that stands in several is named with its group.

    ``F@2`` is the channel F of group 2, counted from 0; ``F@2.5`` the one at place 5 of that group
    where even that holds more than one.
    """
    places: dict[str, tuple[int, int]] = {}
    for name, held in found.items():
        groups = [group for group, _ in held]
        for group, index in held:
            suffix = f"@{group}" if groups.count(group) == 1 else f"@{group}.{index}"
            places[f"{name}{suffix}" if len(held) > 1 else name] = group, index
    return places


def _check(path: Path, name: str, file: Any, group: int, index: int) -> None:
    """Refuse, before anything is read, what is not a column of numbers with a time of numbers."""
    old = file.version < "4"
    held = file.groups[group]
    channel = held.channels[index]
    composed = bool(held.channel_dependencies and held.channel_dependencies[index])
    if composed or not (old or channel.channel_type in _PLAIN_4):
        raise InputError(path, Fault(name, "", "holds no numbers", "name another channel"))
    check_size(path, name, _bytes(held.channel_group) // 8)
    for one in (channel, *_masters(file, group)):
        kind = getattr(one.conversion, "conversion_type", 0)
        if kind not in (_BY_NUMBERS_3 if old else _BY_NUMBERS_4):
            rule = "is scaled by a formula or texts, and nothing from a file is evaluated"
            remedy = "export the channel, and its time, with physical values"
            raise InputError(path, Fault(one.name, "", rule, remedy))


def _bytes(group: Any) -> int:
    """Return what the records of a group take, with room for its values as numbers."""
    invalid = getattr(group, "invalidation_bytes_nr", 0)
    return int(group.cycles_nr) * max(8, int(group.samples_byte_nr) + int(invalid))


def _masters(file: Any, group: int) -> Iterator[Any]:
    """Yield the channels of time that a group's values are read with, its own or another's."""
    for _ in range(_DEEPEST):
        held = file.groups[group]
        if group in file.masters_db:
            yield held.channels[file.masters_db[group]]
        further = getattr(held.channel_group, "cg_master_index", None)
        if further is None:
            return
        group = further
