"""Labelled data sets on disk, as NetCDF: one writer, and the way back.

A data set is built in memory and its bytes are handed to the writer of whole files, since a disk
that fills up under an open HDF5 file takes the process with it.
"""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mptune.errors import Fault, InputError
from mptune.files import read_whole, write_whole
from mptune.hdf5 import check_total, stored_arrays

if TYPE_CHECKING:
    import xarray as xr

_ENGINE: Final = "h5netcdf"
_LARGEST: Final = 2_000_000_000  # bytes


def write_dataset(path: str | Path, dataset: xr.Dataset) -> Path:
    """Write a data set as NetCDF, whole or not at all.

    Raises
    ------
    OutputError
        If the file cannot be written; an earlier file of that name is then untouched.
    """
    stream = io.BytesIO()
    dataset.to_netcdf(stream, engine=_ENGINE)
    return write_whole(path, stream.getvalue())


def read_dataset(path: str | Path, remedy: str = "make it again") -> xr.Dataset:
    """Return a stored data set, read whole.

    Raises
    ------
    InputError
        If the file cannot be read; with ``remedy``.
    """
    import h5py
    import xarray as xr

    try:
        content = io.BytesIO(read_whole(path, _LARGEST, remedy))
        with h5py.File(content, "r") as file:
            check_total(Path(path), stored_arrays(Path(path), file), _LARGEST)
        with xr.open_dataset(content, engine=_ENGINE) as dataset:
            return dataset.load()
    except InputError:
        raise
    except Exception as error:  # damaged files break these libraries in many ways
        rule = f"cannot be read: {str(error)[:200]}"
        raise InputError(path, Fault("", "", rule, remedy)) from error
