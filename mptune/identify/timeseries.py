"""Records of force reference and force from files: CSV, MAT up to version 7.3, MDF4.

A channel is given as ``name`` or ``name [unit]``. CSV headings and MDF channels carry their units;
MAT files know none, so that the unit has to be written. Variables within structures of MAT files
have dotted names, ``log.F_ref``. Time is a channel too (``time [ms]``), or the time between samples
is given.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import frozen
from mptune.errors import Fault, InputError
from mptune.escaping import file_name
from mptune.identify.channels import read_channels
from mptune.units import UnitError, label_and_unit, parse_quantity

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.identify.channel import Channel, Channels

_TIMES = ("time", "t")
_JITTER = 0.1  # of a sample: recorders round their times


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
    given, as a quantity.
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
        If the file cannot be read, a channel is missing or has no unit or a wrong one, or the
        samples are not equally spaced.
    """
    path = Path(path)
    channels = read_channels(path)
    reference, force = (_channel(path, channels, text) for text in (asked.reference, asked.force))
    if len(reference.values) != len(force.values):
        rule = f"has {len(force.values)} samples, {asked.reference} has {len(reference.values)}"
        raise InputError(path, Fault(asked.force, "", rule, "record both together"))
    if asked.sample_time:
        sample_time = _quantity(path, "sample time", asked.sample_time, "s")
    else:
        time = _time(path, channels, asked, (reference, force))
        sample_time = _even_step(path, time)
    return Record(
        frozen(reference.values * _scale(path, asked.reference, reference.unit, "N")),
        frozen(force.values * _scale(path, asked.force, force.unit, "N")),
        sample_time,
        file_name(path.stem),
    )


def _channel(path: Path, channels: Channels, text: str) -> Channel:
    """Return one channel, with the unit that the text or the file gives it."""
    name, unit = label_and_unit(text)
    if name not in channels.names:
        known = ", ".join(channels.names[:30]) or "none at all"
        raise InputError(path, Fault(name, "", "is no channel of it", f"it has: {known}"))
    found = channels.read(name)
    if unit and found.unit and unit != found.unit:
        rule = f"is in {found.unit} by the file"
        raise InputError(path, Fault(text, "", rule, "leave the unit out, or mend the file"))
    return found._replace(unit=unit or found.unit)


def _time(
    path: Path, channels: Channels, asked: Asked, both: tuple[Channel, Channel]
) -> FloatArray:
    """Return the instants of the samples [s], ``(T,)``."""
    reference, force = both
    if not asked.time and reference.time is not None and force.time is not None:
        if not np.array_equal(reference.time, force.time):
            rule = f"is not sampled at the instants of {asked.reference}"
            remedy = "resample both to one raster"
            raise InputError(path, Fault(asked.force, "", rule, remedy))
        return reference.time
    wanted = asked.time or next((one for one in channels.names if one.lower() in _TIMES), "")
    if not wanted:
        remedy = "name the channel of time, or give the time between samples"
        raise InputError(path, Fault("time", "", "is no channel of it", remedy))
    time = _channel(path, channels, wanted)
    if len(time.values) != len(reference.values):
        rule = f"has {len(time.values)} samples, {asked.reference} has {len(reference.values)}"
        raise InputError(path, Fault(wanted, "", rule, "record both together"))
    return time.values * _scale(path, wanted, time.unit, "s")


def _even_step(path: Path, time: FloatArray) -> float:
    """Return the time between samples, having checked that it is the same throughout."""
    if len(time) < 2:
        raise InputError(path, Fault("time", "", "has less than two samples", "record longer"))
    if not np.isfinite(time).all():
        rule = f"is not a number, first at sample {int(np.argmin(np.isfinite(time))) + 1}"
        raise InputError(path, Fault("time", "", rule, "cut the record to where it is whole"))
    step = float(time[-1] - time[0]) / (len(time) - 1)
    usual = float(np.median(np.diff(time)))
    off = np.abs(np.diff(time) - usual) > _JITTER * abs(usual)
    if step <= 0 or usual <= 0 or off.any():
        place = int(np.argmax(off)) + 2 if off.any() else 2
        rule = f"does not step evenly: {1e3 * usual:.4g} ms, but not before sample {place}"
        raise InputError(path, Fault("time", "", rule, "resample the record, or cut the gap out"))
    return step


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
