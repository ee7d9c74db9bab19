"""From records to frequency responses: whole periods of a multisine, or Welch's method.

Both speak about the record as it is. A force reference recorded before the hold of the sampled
controller gives a response that includes the hold's T_S/2; one recorded behind it, as stairs, does
not.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import frozen
from mptune.errors import Fault, InputError
from mptune.identify.response import FrequencyResponse

if TYPE_CHECKING:
    from mptune.arrays import ComplexArray, FloatArray

_FEWEST_SAMPLES = 64
_SEGMENTS = 12  # of Welch's method by default: with half overlap 23 averages
_LEAST_POWER = 1e-4  # of the strongest frequency's: below it the record says nothing


def periodic_response(
    u: FloatArray,
    y: FloatArray,
    sample_time: float,
    omega: FloatArray,
    periods: int,
    name: str,
) -> FrequencyResponse:
    """Return the response at the excited lines of a periodic input.

    Nothing leaks between the lines of a whole number of periods, so that no window is needed.

    Parameters
    ----------
    u, y
        ``(T,)`` input and output over whole periods, the transient left out.
    sample_time
        Time between samples [s].
    omega
        ``(F,)`` excited frequencies [rad/s], whole multiples of the period's own.
    periods
        Number of periods in the record.
    name
        Where the record comes from, in words.

    Returns
    -------
    FrequencyResponse
        Response averaged over the periods; γ² from their scatter, NaN where there is one period
        only. Lines with hardly any input have no response.

    Raises
    ------
    InputError
        If the record is too short, not finite, constant, no whole number of periods, or a
        frequency is no line of it.
    """
    _check_record(u, y, sample_time, name)
    if periods < 1 or len(u) % periods:
        rule = f"has {len(u)} samples, which {periods} periods do not share evenly"
        raise InputError(name, Fault("periods", str(periods), rule, "cut the record to periods"))
    samples = len(u) // periods
    lines = np.asarray(omega) * samples * sample_time / (2 * np.pi)
    index = np.rint(lines).astype(np.int64)
    off = (np.abs(lines - index) > 1e-3) | (index < 1) | (index > (samples - 1) // 2)
    if off.any():
        step = 2 * np.pi / (samples * sample_time)
        rule = f"is no line of the record, whose lines are {step:.6g} rad/s apart"
        fault = Fault("omega", f"{omega[int(np.argmax(off))]:g} rad/s", rule, "choose its lines")
        raise InputError(name, fault)
    at_input = np.fft.rfft(np.reshape(u, (periods, samples)))[:, index]
    at_output = np.fft.rfft(np.reshape(y, (periods, samples)))[:, index]
    power = np.mean(np.abs(at_input) ** 2, axis=0)
    response = _quotient(np.mean(at_output * at_input.conj(), axis=0), power)
    quality = np.full(len(index), np.nan)
    if periods > 1:
        scatter = np.sum(np.abs(at_output - response * at_input) ** 2, axis=0) / (periods - 1)
        coherent = np.abs(response) ** 2 * power
        np.divide(coherent, coherent + scatter, out=quality, where=coherent + scatter > 0)
    return _response(omega, response, quality, name)


def welch_response(
    u: FloatArray,
    y: FloatArray,
    sample_time: float,
    name: str,
    *,
    segment: float | None = None,
    band: tuple[float, float] = (0.0, np.inf),
) -> FrequencyResponse:
    """Return the response of any record, by Welch's method: Hann window, half overlap.

    The window smears the response over about four frequency steps, and a dead time d takes the
    share d/segment off its magnitude: both err little while the segment is long.

    Parameters
    ----------
    u, y
        ``(T,)`` input and output.
    sample_time
        Time between samples [s].
    name
        Where the record comes from, in words.
    segment
        Length of a segment [s]; a twelfth of the record where None.
    band
        Lowest and highest frequency wanted [rad/s].

    Returns
    -------
    FrequencyResponse
        Response S_yu/S_uu and coherence; frequencies with hardly any input have neither.

    Raises
    ------
    InputError
        If the record is too short, not finite or constant, or holds less than two segments.
    """
    from scipy import signal

    _check_record(u, y, sample_time, name)
    samples = len(u) // _SEGMENTS if segment is None else round(segment / sample_time)
    if not _FEWEST_SAMPLES // 4 <= samples <= len(u) // 2:
        rule = f"is {samples} samples of a record of {len(u)}"
        remedy = f"take {_FEWEST_SAMPLES // 4} samples at least, and half the record at most"
        raise InputError(name, Fault("segment", "", rule, remedy))
    settings = {"fs": 1 / sample_time, "nperseg": samples}
    frequency, cross = signal.csd(u, y, **settings)
    input_power, output_power = (signal.welch(one, **settings)[1] for one in (u, y))
    omega = 2 * np.pi * frequency
    wanted = (omega > 0) & (omega >= band[0]) & (omega <= band[1])
    wanted &= frequency < 0.5 / sample_time  # the last line has no phase
    if not wanted.any():
        rule = f"holds none of the record's frequencies, up to {omega[-1]:.4g} rad/s"
        raise InputError(name, Fault("band", f"{band}", rule, "widen it"))
    omega, cross = omega[wanted], cross[wanted]
    input_power, output_power = input_power[wanted], output_power[wanted]
    response = _quotient(cross, input_power)
    quality = np.full(len(omega), np.nan)
    coherent = np.abs(response) ** 2 * input_power
    np.divide(coherent, output_power, out=quality, where=output_power > 0)
    return _response(omega, response, np.minimum(quality, 1.0), name)


def _quotient(cross: ComplexArray, power: FloatArray) -> ComplexArray:
    """Return the response, NaN where the input has too little power to speak of one."""
    response = np.full(len(power), np.nan, np.complex128)
    enough = (power > 0) & (power >= _LEAST_POWER * power.max())
    response[enough] = cross[enough] / power[enough]
    return response


def _response(
    omega: FloatArray, response: ComplexArray, quality: FloatArray, name: str
) -> FrequencyResponse:
    return FrequencyResponse(
        frozen(np.array(omega, np.float64)), frozen(response), frozen(quality), name
    )


def _check_record(u: FloatArray, y: FloatArray, sample_time: float, name: str) -> None:
    """Refuse a record that no response can be taken from."""
    if len(u) != len(y):
        rule = f"has {len(u)} samples where the output has {len(y)}"
        raise InputError(name, Fault("input", "", rule, "record both together"))
    if len(u) < _FEWEST_SAMPLES:
        rule = f"is too short: {len(u)} samples where {_FEWEST_SAMPLES} are needed at least"
        raise InputError(name, Fault("", "", rule, "record longer"))
    if not (np.isfinite(sample_time) and sample_time > 0):
        rule = "is no time between samples"
        raise InputError(name, Fault("sample time", f"{sample_time:g} s", rule, "give it above 0"))
    for key, values in (("input", u), ("output", y)):
        bad = ~np.isfinite(values)
        if bad.any():
            rule = f"is not a number in {bad.sum()} places, first at sample {np.argmax(bad) + 1}"
            raise InputError(name, Fault(key, "", rule, "cut the record to where it is whole"))
    if np.ptp(u) <= 1e-12 * np.abs(u).max():
        raise InputError(name, Fault("input", f"{u[0]:g}", "is constant", "excite the force loop"))
