"""Wherever a path goes, a plain string will do."""

import numpy as np

import mptune
from mptune.campaign.store import CampaignStore
from mptune.files import make_folder
from mptune.robust.store import write_sweep


def test_gains_and_responses_are_written_and_read_by_strings(results, tmp_path):
    path = str(tmp_path / "gains.toml")
    assert mptune.write_gains(path, results["gains file"]) == tmp_path / "gains.toml"
    assert mptune.read_gains(path) == results["gains file"]
    path = str(tmp_path / "rig.csv")
    mptune.write_response(path, results["response"])
    back = mptune.read_response(path)
    assert back.name == "rig"
    np.testing.assert_array_equal(back.omega, results["response"].omega)


def test_folders_and_data_sets_too(results, tmp_path):
    folder = make_folder(str(tmp_path / "new"))
    assert folder.is_dir()
    assert write_sweep(str(folder / "sweep.nc"), results["sweep"]).is_file()
    store = CampaignStore(str(folder), results["plan"])
    assert store.path == folder / "campaign.nc"
