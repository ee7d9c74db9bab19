"""Frequency responses written, read back, and taken from python-control."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from mptune.errors import InputError, OutputError
from mptune.identify.response import FrequencyResponse
from mptune.identify.responses import from_frd, read_response, write_response

OMEGA = np.geomspace(1, 200, 12)
RESPONSE = 1 / (1 + 0.01j * OMEGA)


def test_what_is_written_comes_back_bit_by_bit(tmp_path):
    quality = np.linspace(0.2, 1, 12)
    quality[3] = np.nan
    made = FrequencyResponse(OMEGA, RESPONSE, quality, "rig")
    found = read_response(write_response(tmp_path / "rig.csv", made))
    np.testing.assert_array_equal(found.omega, OMEGA)
    np.testing.assert_array_equal(found.response, RESPONSE)
    np.testing.assert_array_equal(found.quality, quality)
    assert found.name == "rig"


def test_points_without_a_response_are_not_written(tmp_path):
    value = np.where(np.arange(12) < 4, np.nan, RESPONSE)
    made = FrequencyResponse(OMEGA, value, np.full(12, np.nan), "rig")
    found = read_response(write_response(tmp_path / "rig.csv", made))
    np.testing.assert_array_equal(found.omega, OMEGA[4:])


def test_a_folder_that_is_not_there_is_an_output_error(tmp_path):
    made = FrequencyResponse(OMEGA, RESPONSE, np.full(12, np.nan), "rig")
    with pytest.raises(OutputError):
        write_response(tmp_path / "gone" / "rig.csv", made)


def test_an_frd_of_python_control_is_taken():
    control = pytest.importorskip("control")
    plant = control.tf([1], [0.01, 1])
    found = from_frd(control.frd(plant, OMEGA), "frd")
    np.testing.assert_allclose(found.response, RESPONSE, rtol=1e-12)
    np.testing.assert_allclose(found.omega, OMEGA, rtol=1e-15)
    assert found.name == "frd"


def test_whatever_looks_like_an_frd_is_taken_and_sorted():
    found = from_frd(SimpleNamespace(frequency=OMEGA[::-1], response=RESPONSE[::-1]))
    np.testing.assert_array_equal(found.omega, OMEGA)
    np.testing.assert_array_equal(found.response, RESPONSE)


def test_several_inputs_and_nothing_at_all_are_refused():
    square = np.ones((2, 2, 12), complex)
    with pytest.raises(InputError, match="one input"):
        from_frd(SimpleNamespace(omega=OMEGA, frdata=square))
    with pytest.raises(InputError, match="is missing"):
        from_frd(SimpleNamespace(omega=OMEGA))
