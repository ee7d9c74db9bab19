"""One channel of a data file, what all its readers refuse alike, and how much they read."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from mptune.errors import Fault, InputError

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from mptune.arrays import FloatArray

_MOST_SAMPLES = 50_000_000  # 400 MB: fourteen hours at 1 kHz


class Channel(NamedTuple):
    """One channel: its values as recorded, their unit (empty where the file has none), its time."""

    values: FloatArray  # (T,)
    unit: str
    time: FloatArray | None  # (T,) s, where the format knows it


class Channels(NamedTuple):
    """A file's channels by name."""

    names: tuple[str, ...]
    read: Callable[[str], Channel]


def check_size(path: Path, name: str, count: int) -> None:
    """Refuse a channel, before any value is read, that is longer than records are.

    Raises
    ------
    InputError
        With what it would take.
    """
    if count > _MOST_SAMPLES:
        rule = f"has {count:.3g} samples, {8e-9 * count:.3g} GB; {_MOST_SAMPLES:.0e} are read"
        raise InputError(path, Fault(name, "", rule, "cut the record, or resample it"))


def unreadable(path: Path, kind: str, error: Exception) -> InputError:
    """Return the error of a file that its reader breaks on."""
    rule = f"is no whole {kind} ({type(error).__name__}: {str(error)[:80]})"
    return InputError(path, Fault("", "", rule, "record or copy it again"))
