"""Records of force reference and force from files: CSV, MAT up to version 7.3, MDF4.

A channel is given as ``name`` or ``name [unit]``. CSV headings and MDF channels carry their units;
MAT files know none, so that the unit has to be written. Variables within structures of MAT files
have dotted names, ``log.F_ref``, elements of arrays their index, ``u[1]``. A channel of an MDF file
that stands in more than one group is named with its group's number, from 0: ``F@2``. Time is a
channel too (``time [ms]``), or the time between samples is given.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import frozen
from mptune.errors import Fault, InputError
from mptune.escaping import file_name
from mptune.headings import label_and_unit
from mptune.identify.channel import Channel
from mptune.identify.channels import read_channels
from mptune.identify.raster import check_given_step, recorded_step
from mptune.units import UnitError, parse_quantity

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.identify.channel import Channels

_TIMES = ("time", "t")


@dataclass(frozen=True)
class Record:
    """Force reference and force, sampled together.

    Attributes
    ----------
    reference, force
        ``(T,)`` both [N].
    sample_time
        Time between samples [s].
    name
        Where they come from.
    """

    reference: FloatArray
    force: FloatArray
    sample_time: float
    name: str


class Asked(NamedTuple):
    """Which channels of a file hold what, each as ``name`` or ``name [unit]``.

    An empty ``time`` means the channel time or t, and is not needed where the ``sample_time`` is
    given, as a quantity. Where both are there, they must agree.
    """

    reference: str
    force: str
    time: str = ""
    sample_time: str = ""


def read_record(path: str | Path, asked: Asked) -> Record:
    """Return the record of a file.

    Raises
    ------
    InputError
        If the file cannot be read, a channel is missing, stands there twice or has no unit or a
        wrong one, the samples are not equally spaced, or a given time between them contradicts the
        recorded one.
    """
    path = Path(path)
    channels = read_channels(path)
    reference, force = (_channel(path, channels, text) for text in (asked.reference, asked.force))
    if len(reference.values) != len(force.values):
        rule = f"has {len(force.values)} samples, {asked.reference} has {len(reference.values)}"
        raise InputError(path, Fault(asked.force, "", rule, "record both together"))
    sample_time = _sample_time(path, channels, asked, (reference, force))
    return Record(
        _scaled(path, asked.reference, reference, "N"),
        _scaled(path, asked.force, force, "N"),
        sample_time,
        file_name(path.stem),
    )


def _channel(path: Path, channels: Channels, text: str) -> Channel:
    """Return one channel, with the unit that the text or the file gives it."""
    name, unit = (text, "") if text in channels.names else label_and_unit(text)
    alike = [one for one in channels.names if one.startswith(f"{name}@")]
    if name not in channels.names and alike:
        rule, remedy = "stands in more than one group", f"name one: {', '.join(alike[:30])}"
        raise InputError(path, Fault(name, "", rule, remedy))
    if name not in channels.names:
        known = ", ".join(channels.names[:30]) or "none at all"
        raise InputError(path, Fault(name, "", "is no channel of it", f"it has: {known}"))
    found = channels.read(name)
    if unit and found.unit and unit != found.unit:
        rule = f"is in {found.unit} by the file"
        raise InputError(path, Fault(text, "", rule, "leave the unit out, or mend the file"))
    return found._replace(unit=unit or found.unit)


def _sample_time(
    path: Path, channels: Channels, asked: Asked, both: tuple[Channel, Channel]
) -> float:
    """Return the time between samples [s]: as recorded, or as given where that agrees."""
    clock = _clock(path, channels, asked, both)
    if not asked.sample_time:
        if clock is None:
            remedy = "name the channel of time, or give the time between samples"
            raise InputError(path, Fault("time", "", "is no channel of it", remedy))
        name = asked.time or "time"
        return recorded_step(path, _scaled(path, name, clock, "s"))
    given = _quantity(path, "sample time", asked.sample_time, "s")
    if given <= 0:
        raise InputError(path, Fault("sample time", asked.sample_time, "is not above 0", "mend it"))
    if clock is not None:
        values = _scaled(path, asked.time or "time", clock, "s") if clock.unit else clock.values
        check_given_step(path, given, values, "s" if clock.unit else "")
    return given


def _clock(
    path: Path, channels: Channels, asked: Asked, both: tuple[Channel, Channel]
) -> Channel | None:
    """Return the channel of time; None where there is none, or its like is none of this record."""
    reference, force = both
    if not asked.time and reference.time is not None and force.time is not None:
        if not np.array_equal(reference.time, force.time):
            rule = f"is not sampled at the instants of {asked.reference}"
            remedy = "resample both to one raster"
            raise InputError(path, Fault(asked.force, "", rule, remedy))
        return Channel(reference.time, "s", None)
    wanted = asked.time or next((one for one in channels.names if one.lower() in _TIMES), "")
    if not wanted:
        return None
    time = _channel(path, channels, wanted)
    fits = len(time.values) == len(reference.values)
    if asked.sample_time and not asked.time and not (fits and _may_be_time(time.unit)):
        return None  # a temperature T, say, or the time of other channels
    if not fits:
        rule = f"has {len(time.values)} samples, {asked.reference} has {len(reference.values)}"
        raise InputError(path, Fault(wanted, "", rule, "record both together"))
    return time


def _may_be_time(unit: str) -> bool:
    try:
        return not unit or parse_quantity(f"1 {unit}", "s") > 0
    except UnitError:
        return False


def _scaled(path: Path, text: str, channel: Channel, wanted: str) -> FloatArray:
    """Return a channel's values in SI, infinite where they are too large: its user refuses them."""
    with np.errstate(over="ignore"):
        return frozen(channel.values * _scale(path, text, channel.unit, wanted))


def _scale(path: Path, text: str, unit: str, wanted: str) -> float:
    name, _ = label_and_unit(text)
    if not unit:
        remedy = f'write it behind the name, like "{name} [{wanted}]"'
        raise InputError(path, Fault(name, "", "has no unit", remedy))
    return _quantity(path, name, f"1 {unit}", wanted)


def _quantity(path: Path, key: str, text: str, unit: str) -> float:
    try:
        return parse_quantity(text, unit)
    except UnitError as error:
        raise InputError(path, Fault(key, text, error.rule, error.remedy)) from error
