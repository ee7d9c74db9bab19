"""An identification as a labelled data set, and on disk as NetCDF."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.datasets import read_dataset, write_dataset
from mptune.errors import Fault, InputError
from mptune.identify.result import FitStatus, Panel
from mptune.params.gains import version

if TYPE_CHECKING:
    from pathlib import Path

    import xarray as xr

    from mptune.identify.result import IdentifyResult

_PANEL = {
    "position": ("position_m", "m"),
    "oil_bulk_modulus": ("oil_bulk_modulus_pa", "Pa"),
    "valve_delay": ("valve_delay_s", "s"),
    "tau_a": ("tau_a_s", "s"),
    "tau_b": ("tau_b_s", "s"),
    "skipped_points": ("skipped", "1"),
}


def to_dataset(result: IdentifyResult) -> xr.Dataset:
    """Return the identification as a labelled data set.

    Dimensions: ``panel``, ``point`` and ``frequency``. Complex responses are kept as real and
    imaginary parts, for NetCDF has no complex numbers.
    """
    import xarray as xr

    panels = result.panels
    response = np.stack([panel.response for panel in panels])
    theory = np.stack([panel.theory for panel in panels])
    whole = ("panel", "point", "frequency")
    codes = ", ".join(f"{one.value} {one.name.lower().replace('_', ' ')}" for one in FitStatus)
    data = {
        "response_real": xr.DataArray(response.real, dims=whole),
        "response_imaginary": xr.DataArray(response.imag, dims=whole),
        "theory_real": xr.DataArray(theory.real, dims=("panel", "frequency")),
        "theory_imaginary": xr.DataArray(theory.imag, dims=("panel", "frequency")),
        "quality": xr.DataArray(np.stack([panel.quality for panel in panels]), dims=whole),
        "status": xr.DataArray(
            np.stack([panel.status for panel in panels]).astype(np.int8),
            dims=whole,
            attrs={"long_name": codes},
        ),
    }
    first = panels[0]
    coordinates = {
        "frequency": xr.DataArray(first.omega, dims="frequency", attrs={"units": "rad/s"}),
        "velocity": xr.DataArray(first.velocity, dims="point", attrs={"units": "m/s"}),
        "pressure_a": xr.DataArray(first.pressure_a, dims="point", attrs={"units": "Pa"}),
    }
    for name, (field, unit) in _PANEL.items():
        values = [getattr(panel, field) for panel in panels]
        coordinates[name] = xr.DataArray(values, dims="panel", attrs={"units": unit})
    attributes = {
        "study": result.study.name,
        "study_hash": result.study.hash(),
        "mptune_version": version(),
        "excitation": result.excitation.value,
        "satisfied": str(result.satisfied),
    }
    return xr.Dataset(data, coordinates, attributes)


def write_identification(path: str | Path, result: IdentifyResult) -> Path:
    """Write an identification as NetCDF, whole or not at all.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    return write_dataset(path, to_dataset(result))


def read_panels(path: str | Path, study_hash: str) -> tuple[Panel, ...]:
    """Return the panels of a stored identification of one model; none where it is of another.

    Raises
    ------
    InputError
        If the file cannot be read, or holds no identification.
    """
    dataset = read_dataset(path)
    if dataset.attrs.get("study_hash") != study_hash:
        return ()
    try:
        return tuple(_panel(dataset.isel(panel=n)) for n in range(dataset.sizes["panel"]))
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        fault = Fault("", "", "holds no identification", "identify again")
        raise InputError(path, fault) from error


def _panel(one: xr.Dataset) -> Panel:
    alone = {field: float(one[name]) for name, (field, _) in _PANEL.items() if field != "skipped"}
    return Panel(
        **alone,
        skipped=int(one["skipped_points"]),
        omega=one["frequency"].values,
        velocity=one["velocity"].values,
        pressure_a=one["pressure_a"].values,
        response=one["response_real"].values + 1j * one["response_imaginary"].values,
        quality=one["quality"].values,
        status=one["status"].values.astype(np.int64),
        theory=one["theory_real"].values + 1j * one["theory_imaginary"].values,
    )
