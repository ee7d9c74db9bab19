"""Labelled data sets on disk."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from mptune.datasets import read_dataset, write_dataset
from mptune.errors import InputError


def test_a_data_set_comes_back_as_it_was_written(tmp_path):
    values = xr.DataArray(np.arange(6.0).reshape(2, 3), dims=("a", "b"), attrs={"units": "m"})
    written = xr.Dataset({"x": values, "word": ("a", ["τ", ""])}, {"b": [1, 2, 3]}, {"title": "t"})
    path = write_dataset(tmp_path / "one.nc", written)
    assert read_dataset(path).identical(written)
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("content", [b"", b"no data set", b"\x89HDF\r\n\x1a\n" + bytes(40)])
def test_a_damaged_file_is_refused_with_its_remedy(tmp_path, content):
    path = tmp_path / "one.nc"
    path.write_bytes(content)
    with pytest.raises(InputError, match="start again"):
        read_dataset(path, "start again")


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_dataset(tmp_path / "none.nc")
