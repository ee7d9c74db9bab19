"""Traces of a verification as a labelled data set, and on disk as NetCDF."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from mptune.datasets import write_dataset
from mptune.params.chambers import LETTERS
from mptune.params.gains import version
from mptune.sim import closed_loop as loop

if TYPE_CHECKING:
    from pathlib import Path

    import xarray as xr

    from mptune.verify.result import VerifyResult

_COLUMNS = {
    "position_reference": (loop.X_REF, "m"),
    "velocity_reference": (loop.V_REF, "m/s"),
    "position": (loop.POSITION, "m"),
    "velocity": (loop.VELOCITY, "m/s"),
    "pressure_a": (loop.CHAMBER_A, "Pa"),
    "pressure_b": (loop.CHAMBER_B, "Pa"),
    "force_reference": (loop.F_REF, "N"),
    "active": (loop.ACTIVE, "1"),
    "state_a": (loop.STATE_A, "1"),
    "state_b": (loop.STATE_B, "1"),
    "pressure_high": (loop.HIGH_PRESSURE, "Pa"),
    "fed_mass": (loop.FED_MASS, "kg"),
}


def to_dataset(result: VerifyResult) -> xr.Dataset:
    """Return the last movement set of the worst case of each mass, ``(case, time)``."""
    import xarray as xr

    cases = result.worst_per_mass()
    converters = {
        f"converter_{k + 1}": (loop.CONVERTER_1 + k, "m")
        for k in range(result.study.study.converters)
    }
    machine = result.study.study
    columns = loop.chamber_columns(machine.converters, len(machine.all_chambers))
    further = {}
    for place, letter in enumerate(LETTERS[2 : len(columns.states)].lower(), 2):
        further[f"pressure_{letter}"] = (columns.pressures[place], "Pa")
        further[f"state_{letter}"] = (columns.states[place], "1")
    traces = np.stack([case.traces for case in cases])
    time = result.study.study.controller.fast_sampling_period * np.arange(traces.shape[1])
    data = {
        name: xr.DataArray(
            traces[:, :, column].astype(np.float32), dims=("case", "time"), attrs={"units": unit}
        )
        for name, (column, unit) in {**_COLUMNS, **converters, **further}.items()
    }
    coordinates = {
        "time": xr.DataArray(time, dims="time", attrs={"units": "s"}),
        "mass": xr.DataArray([c.mass_kg for c in cases], dims="case", attrs={"units": "kg"}),
        "oil_bulk_modulus": xr.DataArray(
            [c.oil_bulk_modulus_pa for c in cases], dims="case", attrs={"units": "Pa"}
        ),
        "seed": xr.DataArray([c.seed for c in cases], dims="case"),
    }
    attributes = {
        "study": result.study.name,
        "study_hash": result.study.hash(),
        "mptune_version": version(),
        "gains": json.dumps(result.gains.model_dump()),
        "feedforward": json.dumps(result.feedforward.model_dump()),
    }
    return xr.Dataset(data, coordinates, attributes)


def write_traces(path: str | Path, result: VerifyResult) -> Path:
    """Write the traces as NetCDF, whole or not at all.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    return write_dataset(path, to_dataset(result))
