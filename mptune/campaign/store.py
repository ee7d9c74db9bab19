"""Chunk files of a campaign under way, and the one file that they become.

A chunk holds a fixed range of runs and is written whole or not at all. Every file carries the
campaign's identity; a file of another campaign is refused.
"""

from __future__ import annotations

import contextlib
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.campaign.draw import PARAMETER_UNITS
from mptune.campaign.result import CampaignResult
from mptune.campaign.simulate import FIGURES, RunRows
from mptune.datasets import read_dataset, write_dataset
from mptune.errors import Fault, InputError
from mptune.files import make_folder
from mptune.sim.merit import MERITS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import xarray as xr

    from mptune.arrays import FloatArray, IntArray
    from mptune.campaign.plan import Plan

_IDENTITY = "campaign_identity"
_SHOWN = 3  # differences
_REMEDY = "delete it; --resume runs it again"


class CampaignStore:
    """A campaign's files: ``campaign/chunk-000000.nc`` … and in the end ``campaign.nc``."""

    def __init__(self, folder: str | Path, plan: Plan) -> None:
        self._plan = plan
        self._identity = plan.identity()
        self.path = Path(folder) / "campaign.nc"
        self.chunk_folder = Path(folder) / "campaign"

    def begin(self, *, resume: bool) -> None:
        """Make room for the campaign's chunks.

        Raises
        ------
        InputError
            If chunks stand there and ``resume`` is False, or a campaign of another seed: it would
            be replaced, though nothing but luck tells the two apart.
        """
        self._keep_other_seed()
        found = sorted(self.chunk_folder.glob("chunk-*.nc"))
        if found and not resume:
            fault = Fault(
                "",
                "",
                f"holds {len(found)} chunks of a campaign that was not finished",
                "go on with --resume, choose another --out, or delete that folder",
            )
            raise InputError(self.chunk_folder, fault)
        make_folder(self.chunk_folder)

    def _keep_other_seed(self) -> None:
        try:
            stored = read_dataset(self.path).attrs
            seed = json.loads(stored["campaign"])["seed"]
        except (InputError, KeyError, TypeError, ValueError):
            return  # there is none, or none that can be read
        own = self._plan.study.study.campaign.seed
        if seed != own:
            rule = f"holds a campaign of seed {seed}, and this one has seed {own}"
            remedy = "choose another --out, or move that file"
            raise InputError(self.path, Fault("campaign.seed", str(own), rule, remedy))

    def missing(self) -> list[int]:
        """Return the numbers of the chunks that are still to be run.

        Raises
        ------
        InputError
            If a chunk cannot be read, or belongs to another campaign.
        """
        missing = []
        for number in range(len(self._plan.chunks)):
            path = self._chunk(number)
            if path.exists():
                self._read(path)
            else:
                missing.append(number)
        return missing

    def finished(self) -> CampaignResult | None:
        """Return the campaign if its one file stands already; None where it does not."""
        if not self.path.exists():
            return None
        dataset = read_dataset(self.path, _REMEDY)
        if dataset.attrs.get(_IDENTITY) != self._identity:
            return None
        return self._result(dataset)

    def write_chunk(self, number: int, rows: Sequence[RunRows]) -> None:
        """Write one chunk, whole or not at all.

        Raises
        ------
        OutputError
            If the file cannot be written.
        """
        dataset = _dataset(
            self._plan,
            np.concatenate([np.array(one.number, np.int64) for one in rows]),
            np.concatenate([one.figures for one in rows]),
            [status for one in rows for status in one.status],
            [reason for one in rows for reason in one.reason],
        )
        write_dataset(self._chunk(number), dataset)

    def merge(self) -> CampaignResult:
        """Make one file of all chunks, then remove them.

        Raises
        ------
        InputError
            If a chunk is missing, cannot be read, or belongs to another campaign.
        OutputError
            If the file cannot be written; the chunks then stay.
        """
        import xarray as xr

        chunks = [self._read(self._chunk(number)) for number in range(len(self._plan.chunks))]
        dataset = xr.concat(chunks, "run", combine_attrs="override")
        result = self._result(dataset)
        write_dataset(self.path, dataset)
        self.discard_chunks()
        return result

    def discard_chunks(self) -> None:
        """Remove the chunks, and what a kill left beside them."""
        for path in (*self.chunk_folder.glob("chunk-*.nc"), *self.chunk_folder.glob(".chunk-*")):
            path.unlink(missing_ok=True)
        with contextlib.suppress(OSError):
            self.chunk_folder.rmdir()

    def _chunk(self, number: int) -> Path:
        return self.chunk_folder / f"chunk-{number:06d}.nc"

    def _read(self, path: Path) -> xr.Dataset:
        dataset = read_dataset(path, _REMEDY)
        if dataset.attrs.get(_IDENTITY) != self._identity:
            fault = Fault(
                _IDENTITY,
                f"{str(dataset.attrs.get(_IDENTITY))[:12]}…",
                f"belongs to another campaign than this one ({self._identity[:12]}…): "
                f"{self._difference(dataset.attrs)}",
                "resume with what it was begun with, choose another --out, or delete that folder",
            )
            raise InputError(path, fault)
        return dataset

    def _difference(self, stored: Mapping[str, Any]) -> str:
        """Return in which settings a stored campaign differs from this one, in words."""
        try:
            theirs, own = json.loads(stored["campaign"]), self._plan.values()["campaign"]
            changed = [key for key in own if theirs.get(key) != json.loads(json.dumps(own[key]))]
            pairs = [
                f"{key} {theirs.get(key)!r:.40} there, {own[key]!r:.40} here" for key in changed
            ]
        except (AttributeError, KeyError, TypeError, ValueError):
            pairs = []
        return "; ".join(pairs[:_SHOWN]) or "study, gains or version differ"

    def _result(self, dataset: xr.Dataset) -> CampaignResult:
        if not np.array_equal(dataset["run"], np.arange(self._plan.runs)):
            fault = Fault(
                "run", "", "does not hold every run exactly once", "delete it and run again"
            )
            raise InputError(self.path, fault)
        return CampaignResult(
            plan=self._plan,
            figures=np.stack([dataset[name].to_numpy() for name in FIGURES], axis=1),
            status=dataset["status"].to_numpy().astype(np.str_),
            reason=dataset["reason"].to_numpy().astype(np.str_),
        )


def to_dataset(result: CampaignResult) -> xr.Dataset:
    """Return a campaign as a labelled data set over its runs, as ``campaign.nc`` holds it."""
    runs = np.arange(result.plan.runs)
    return _dataset(
        result.plan, runs, result.figures, result.status.tolist(), result.reason.tolist()
    )


def _dataset(
    plan: Plan, index: IntArray, figures: FloatArray, status: list[str], reason: list[str]
) -> xr.Dataset:
    import xarray as xr

    points = plan.points[index]
    data = {
        name: xr.DataArray(points[:, place], dims="run", attrs={"units": unit})
        for place, (name, unit) in enumerate(PARAMETER_UNITS.items())
    }
    for place, one in enumerate(MERITS):
        data[one.key] = xr.DataArray(figures[:, place], dims="run", attrs={"units": one.unit})
    data["status"] = xr.DataArray(np.array(status, object), dims="run")
    data["reason"] = xr.DataArray(np.array(reason, object), dims="run")
    values = plan.values()
    attributes = {
        "study": plan.study.name,
        "study_hash": plan.study.hash(),
        _IDENTITY: plan.identity(),
        "mptune_version": values["version"],
        "campaign": json.dumps(values["campaign"]),
        "gains": json.dumps(values["gains"]),
        "feedforward": json.dumps(values["feedforward"]),
    }
    return xr.Dataset(data, {"run": index}, attributes)
