"""A sweep as a labelled data set, and on disk as NetCDF."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from mptune.datasets import write_dataset
from mptune.loops.broken import NAMES
from mptune.params.gains import version

if TYPE_CHECKING:
    from pathlib import Path

    import xarray as xr
    from numpy.typing import NDArray

    from mptune.robust.result import SweepResult

_UNITS = {"mass": "kg", "delay": "s", "tau_a": "s", "tau_b": "s"}
_MARGIN_UNITS = {
    "frequency": "rad/s",
    "phase_margin": "rad",
    "delay_margin": "s",
    "peak_compliance": "m/N",
}


def to_dataset(result: SweepResult) -> xr.Dataset:
    """Return the sweep as a labelled data set.

    Dimensions: ``condition`` (Eq. 17, Eq. 21), ``frequency``, ``plant``, ``loop`` (velocity,
    position, force) and ``path`` (none, filters, sampled). Envelopes are kept with the plant behind
    each frequency, and each plant's worst ratio; whole curves are not.
    """
    import numpy as np
    import xarray as xr

    members = result.members
    plants = result.model.whole_family
    count = len(plants.mass)
    per_frequency = ("condition", "frequency")
    data: dict[str, xr.DataArray] = {}
    for name, meaning in (
        ("left", "largest multiplicative error over the family"),
        ("right", "|(1 + L_N)/L_N| of the nominal loop"),
        ("allowed", "largest allowed left/right ratio"),
        ("plant", "plant behind the envelope"),
    ):
        values = np.stack([getattr(condition, name) for condition in result.conditions])
        key = "plant_behind" if name == "plant" else name
        data[key] = xr.DataArray(values, dims=per_frequency, attrs={"long_name": meaning})
    ratios = np.stack([condition.plant_ratio for condition in result.conditions])
    data["plant_ratio"] = xr.DataArray(
        ratios, dims=("condition", "plant"), attrs={"long_name": "each plant's worst ratio"}
    )
    families = [*result.families, *([result.sampled] if result.sampled else [])]
    for name in families[0].margins._fields:
        values = np.stack([_padded(getattr(family.margins, name), count) for family in families])
        unit = _MARGIN_UNITS.get(name, _MARGIN_UNITS.get(name.rsplit("_", 1)[-1], "1"))
        data[name] = xr.DataArray(values, dims=("path", "loop", "plant"), attrs={"units": unit})
    data["stable"] = xr.DataArray(
        np.stack([_padded(family.stable, count, fill=-1) for family in families]),
        dims=("path", "plant"),
        attrs={"long_name": "1 where the whole closed loop is certainly stable, -1 not asked"},
    ).astype(np.int8)
    coordinates: dict[str, object] = {
        "condition": ["velocity", "position"],
        "loop": list(NAMES),
        "path": [family.path for family in families],
        "frequency": xr.DataArray(result.omega, dims="frequency", attrs={"units": "rad/s"}),
    }
    for name, unit in _UNITS.items():
        column = getattr(plants, name)
        coordinates[name] = xr.DataArray(column, dims="plant", attrs={"units": unit})
    explicit = result.model.explicit.delay
    coordinates["delay_as_it_runs"] = xr.DataArray(
        np.concatenate([explicit, np.full(count - len(explicit), np.nan)]),
        dims="plant",
        attrs={"units": "s", "long_name": "delay with the paths filters and sampled"},
    )
    if members is not None:
        names = [""] * len(result.plants.mass) + list(members.names)
        attributes = {"long_name": "measured response behind the plant"}
        coordinates["response"] = xr.DataArray(names, dims="plant", attrs=attributes)
    return xr.Dataset(data, coordinates, _attributes(result))


def _padded(values: NDArray[Any], count: int, fill: float = float("nan")) -> NDArray[Any]:
    """Return figures of a family with room for the box's plants that it leaves out, in front."""
    import numpy as np

    left_out = count - values.shape[-1]
    if left_out == 0:
        return values
    room = np.full((*values.shape[:-1], left_out), fill)
    return np.concatenate([room, values], axis=-1)


def _attributes(result: SweepResult) -> dict[str, str]:
    return {
        "title": result.study.title,
        "study": result.study.name,
        "study_hash": result.study.hash(),
        "uncertainty": result.study.uncertainty_name,
        "mptune_version": version(),
        "gains": json.dumps(result.gains.model_dump()),
        "satisfied": str(result.satisfied),
    }


def write_sweep(path: str | Path, result: SweepResult) -> Path:
    """Write a sweep as NetCDF, whole or not at all.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    return write_dataset(path, to_dataset(result))
