"""Kills that nothing can catch, at moments that nothing chooses: no run is lost or made twice."""

import multiprocessing
import os
import signal
import time

import numpy as np
import pytest
import xarray as xr

from mptune.campaign.campaign import run_campaign
from mptune.campaign.workers import Workers, workers

pytestmark = [
    pytest.mark.compiled,  # interpreted, it would take minutes
    pytest.mark.skipif(os.name != "posix", reason="signals of POSIX"),
]

# xarray asks for distributed when it writes, where that is installed.
PRELOADED = ["mptune.campaign.campaign", "joblib", "xarray", "h5netcdf", "distributed"]


def work(plan, folder, resume):
    run_campaign(plan, folder, Workers(1, {"backend": "sequential"}), resume=resume)


def chunks(folder):
    return {path: path.stat().st_mtime_ns for path in (folder / "campaign").glob("chunk-*.nc")}


@pytest.mark.parametrize("kills", [2, pytest.param(10, marks=pytest.mark.fuzz)])
def test_kills_leave_the_campaign_as_if_there_had_been_none(plan, run, tmp_path, kills):
    runs = 3 * (kills + 3)
    one = plan(f"runs={runs}", "chunk=3", "noise=[0.5, 2]")
    run(one, tmp_path / "undisturbed")
    killed = tmp_path / "killed"
    killed.mkdir()
    spawn = multiprocessing.get_context("forkserver")
    spawn.set_forkserver_preload([*PRELOADED, __name__])
    moments, before = np.random.default_rng(4), {}
    for kill in range(kills):
        child = spawn.Process(target=work, args=(one, killed, kill > 0))
        child.start()
        while len(chunks(killed)) <= len(before):
            assert child.is_alive()
            time.sleep(0.002)
        time.sleep(moments.uniform(0, 0.05))
        child.kill()
        child.join()
        assert child.exitcode == -signal.SIGKILL
        after = chunks(killed)
        assert before.items() <= after.items()  # what was finished is neither lost nor rewritten
        before = after
    assert len(before) < kills + 3
    work(one, killed, True)
    assert not (killed / "campaign").exists()
    stores = [folder / "campaign.nc" for folder in (tmp_path / "undisturbed", killed)]
    first, second = (xr.load_dataset(path, engine="h5netcdf") for path in stores)
    assert first.identical(second)
    assert np.array_equal(second["run"], np.arange(runs))


@pytest.fixture(scope="module")
def cluster():
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None
    ) as one:
        yield one


def test_a_cluster_gives_the_same_bits_even_where_a_worker_is_killed(cluster, plan, run, tmp_path):
    one = plan("runs=120", "chunk=40", "noise=[0.5, 2]")
    alone = run(one, tmp_path / "alone")
    victim = cluster.workers[0].process.pid
    killed = []

    def kill_once(_stage, share):
        if share >= 0.2 and not killed:
            os.kill(victim, signal.SIGKILL)
            killed.append(share)

    (tmp_path / "cluster").mkdir()
    with workers(scheduler=cluster.scheduler_address) as team:
        assert team.count == 2
        spread = run_campaign(one, tmp_path / "cluster", team, kill_once)
    assert killed
    assert np.array_equal(alone.figures, spread.figures, equal_nan=True)
    first, second = (
        xr.load_dataset(tmp_path / name / "campaign.nc", engine="h5netcdf")
        for name in ("alone", "cluster")
    )
    assert first.identical(second)
