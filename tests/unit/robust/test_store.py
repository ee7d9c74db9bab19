"""The stored sweep: labelled, with units, whole or not at all."""

import numpy as np
import pytest
import xarray as xr

from mptune.robust.store import write_sweep

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes


def test_stored_sweep_names_the_worst_plant_again(fig_5, tmp_path):
    path = write_sweep(tmp_path / "sweep.nc", fig_5)
    with xr.open_dataset(path, engine="h5netcdf") as stored:
        ratio = (stored["left"] / stored["right"]).sel(condition="velocity")
        worst = int(ratio.argmax("frequency"))
        assert float(ratio[worst]) == fig_5.velocity.ratio.max()
        plant = stored.isel(plant=int(stored["plant_behind"].sel(condition="velocity")[worst]))
        assert float(plant["mass"]) == fig_5.velocity.at.mass_kg
        assert float(plant["delay"]) == fig_5.velocity.at.delay_s
        assert stored["frequency"].attrs["units"] == "rad/s"
        assert stored["delay_margin"].attrs["units"] == "s"
        assert stored.attrs["study_hash"] == fig_5.study.hash()


def test_unstable_plants_have_no_margins(fig_5_twice, tmp_path):
    path = write_sweep(tmp_path / "sweep.nc", fig_5_twice)
    with xr.open_dataset(path, engine="h5netcdf") as stored:
        unstable = stored["stable"].sel(path="filters") == 0
        assert int(unstable.sum()) > 0
        peaks = stored["sensitivity_peak"].sel(path="filters", loop="force")
        assert np.isnan(peaks.values[unstable.values]).all()
        assert np.isfinite(peaks.values[~unstable.values]).all()
