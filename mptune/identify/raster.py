"""The time between a record's samples: as recorded, as given, and that the two agree.

A time that is given does not replace one that is recorded: a wrong one would scale every frequency,
and with it τ and delay, and glue the record over its gaps.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.errors import Fault, InputError
from mptune.units import shown

if TYPE_CHECKING:
    from pathlib import Path

    from mptune.arrays import FloatArray

_JITTER = 0.1  # of a sample: recorders round their times
_AGREEMENT = 0.01  # of the mean step: what rounding leaves between two true figures
_SCALES = (1.0, 1e-3, 1e-6, 1e-9)  # s, ms, µs, ns: what a time without a unit may count


def recorded_step(path: Path, time: FloatArray) -> float:
    """Return the time between samples [s] of the recorded instants, ``(T,)`` [s].

    Raises
    ------
    InputError
        If they are fewer than two, not finite, or do not step evenly.
    """
    return _even_step(path, time, "s")


def check_given_step(path: Path, given: float, time: FloatArray, unit: str) -> None:
    """Refuse a time between samples that contradicts the recorded instants.

    Parameters
    ----------
    path
        The record.
    given
        The time between samples [s], as it is given.
    time
        The recorded instants, ``(T,)`` [s]; in seconds, a decimal part of them or samples where the
        ``unit`` is empty, for the file does not say.
    unit
        ``"s"`` or nothing.

    Raises
    ------
    InputError
        If they do not step evenly, or by another time than the one that is given.
    """
    step = _even_step(path, time, unit)
    scales = (1.0,) if unit else _SCALES
    counted = not unit and abs(step - 1.0) <= _AGREEMENT
    if counted or any(abs(step * scale - given) <= _AGREEMENT * given for scale in scales):
        return
    rule = f"contradicts the recorded time, which steps by {_shown(step, unit)}"
    remedy = "leave it out where the recorded time is right; else mend that, or leave it out"
    raise InputError(path, Fault("sample time", shown(given, "s"), rule, remedy))


def _even_step(path: Path, time: FloatArray, unit: str) -> float:
    """Return the mean step of instants, having checked that it is the same throughout."""
    if len(time) < 2:
        raise InputError(path, Fault("time", "", "has less than two samples", "record longer"))
    if not np.isfinite(time).all():
        rule = f"is not a number, first at sample {int(np.argmin(np.isfinite(time))) + 1}"
        raise InputError(path, Fault("time", "", rule, "cut the record to where it is whole"))
    with np.errstate(over="ignore", invalid="ignore"):  # of times at the end of all floats
        step = float(time[-1] - time[0]) / (len(time) - 1)
        usual = float(np.median(np.diff(time)))
        off = ~(np.abs(np.diff(time) - usual) <= _JITTER * abs(usual))
    if not (step > 0 and usual > 0) or off.any():
        place = int(np.argmax(off)) + 2 if off.any() else 2
        rule = f"does not step evenly: {_shown(usual, unit)}, but not before sample {place}"
        raise InputError(path, Fault("time", "", rule, "resample the record, or cut the gap out"))
    return step


def _shown(step: float, unit: str) -> str:
    return shown(step, unit) if unit else f"{step:.4g} (of no unit)"
