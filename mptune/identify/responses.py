"""Frequency responses from and to files and other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from mptune.arrays import frozen
from mptune.errors import Fault, InputError
from mptune.escaping import file_name
from mptune.files import write_whole
from mptune.identify.response import FrequencyResponse
from mptune.params.measured import read_response_table


def read_response(path: str | Path) -> FrequencyResponse:
    """Return the frequency response of a CSV file; ``mptune.params.measured`` has its rules.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    InputError
        If the file cannot be read or breaks a rule.
    """
    path = Path(path)
    table = read_response_table(path)
    columns = frozen(table.omega), frozen(table.response), frozen(table.coherence)
    return FrequencyResponse(*columns, file_name(path.stem))


def write_response(path: str | Path, response: FrequencyResponse) -> Path:
    """Write the valid points of a response as CSV, so that a study's ``measured`` can name it.

    Parameters
    ----------
    path
        The file to write.
    response
        The response.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    values = response.response
    columns = (response.omega, values.real, values.imag, response.quality)
    rows = np.stack(columns, axis=1)[response.valid].tolist()
    lines = ["frequency [rad/s],real [1],imaginary [1],coherence [1]"]
    lines += [",".join("" if np.isnan(cell) else repr(cell) for cell in row) for row in rows]
    return write_whole(path, "\n".join(lines) + "\n")


def from_frd(frd: Any, name: str = "FRD") -> FrequencyResponse:
    """Return the response of python-control's FRD, or of anything that looks like one.

    Parameters
    ----------
    frd
        It has ``omega`` (or ``frequency``) [rad/s] and ``complex`` (or ``frdata``, ``fresp``,
        ``response``): one output, one input.
    name
        Where it comes from, in words.

    Raises
    ------
    InputError
        If there is more than one input or output, or no response.
    """
    omega = _first(frd, ("omega", "frequency"), name)
    values = np.squeeze(np.asarray(_first(frd, ("complex", "frdata", "fresp", "response"), name)))
    omega = np.atleast_1d(np.asarray(omega, np.float64))
    values = np.atleast_1d(values).astype(np.complex128)
    if values.shape != omega.shape:
        rule = f"has the shape {values.shape} over {len(omega)} frequencies"
        raise InputError(name, Fault("response", "", rule, "choose one input and one output"))
    order = np.argsort(omega)
    unknown = np.full(len(omega), np.nan)
    return FrequencyResponse(frozen(omega[order]), frozen(values[order]), frozen(unknown), name)


def _first(frd: Any, keys: tuple[str, ...], name: str) -> Any:
    for key in keys:
        value = getattr(frd, key, None)
        if value is not None:
            return value
    raise InputError(name, Fault(keys[0], "", "is missing", "give a frequency response"))
