"""An identification on disk says what the result says."""

import numpy as np
import pytest
import xarray as xr

from mptune.identify.identify import identify
from mptune.identify.store import write_identification

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes


def test_everything_comes_back(load_boom, tmp_path):
    result = identify(
        load_boom(
            'identification.pressures=["3 MPa", "13 MPa"]',
            'identification.frequency=["100 rad/s", "200 rad/s"]',
            "identification.frequencies=2",
            "identification.amplitude=400 N",  # some fits fail
            'identification.oil_bulk_moduli=["800 MPa"]',
            'identification.valve_delays=["0 ms", "5 ms"]',
        )
    )
    path = write_identification(tmp_path / "identification.nc", result)
    with xr.open_dataset(path, engine="h5netcdf") as data:
        assert data.sizes == {"panel": 4, "point": 3, "frequency": 2}
        assert data.attrs["excitation"] == "sine"
        assert data.attrs["study_hash"] == result.study.hash()
        assert data.frequency.attrs["units"] == "rad/s"
        for k, panel in enumerate(result.panels):
            one = data.isel(panel=k)
            response = one.response_real.values + 1j * one.response_imaginary.values
            np.testing.assert_array_equal(response, panel.response)
            theory = one.theory_real.values + 1j * one.theory_imaginary.values
            np.testing.assert_array_equal(theory, panel.theory)
            np.testing.assert_array_equal(one.status, panel.status)
            np.testing.assert_array_equal(one.velocity, panel.velocity)
            assert float(one.valve_delay) == panel.valve_delay_s
            assert int(one.skipped_points) == 3
