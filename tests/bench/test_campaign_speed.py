"""How fast campaigns are, on two cores and on a cluster, and that their memory stays flat.

Run with ``make bench``. ``MPTUNE_BENCH_RUNS=10000`` tells whether memory stays flat at length; a
run is one movement set of 9 s. Machines that share their cores with others show too little.
"""

import os
import time

import numpy as np
import psutil
import pytest

from mptune.campaign.campaign import run_campaign
from mptune.campaign.plan import plan_campaign
from mptune.campaign.workers import workers
from mptune.params.load import load_study

pytestmark = pytest.mark.bench

RUNS = int(os.environ.get("MPTUNE_BENCH_RUNS", "400"))
FEWER = max(RUNS // 10, 160)


class Watch:
    """Takes down when runs were done, and how much memory all processes had."""

    def __init__(self, runs):
        self.runs, self.done, self.at, self.bytes = runs, [], [], []

    def __call__(self, _stage, share):
        self.done.append(share * self.runs)
        self.at.append(time.perf_counter())
        own = psutil.Process()
        self.bytes.append(sum(one.memory_info().rss for one in (own, *own.children())))

    def rate(self):
        """Return runs per second once every worker is under way."""
        begin = 4  # results
        return (self.done[-1] - self.done[begin]) / (self.at[-1] - self.at[begin])

    def growth(self):
        """Return by how many MiB memory grew from the first fifth to the end."""
        return (self.bytes[-1] - self.bytes[len(self.bytes) // 5]) / 2**20


@pytest.fixture
def timed(study_file, tmp_path):
    """Run a campaign of so many runs; return what was watched and the result."""

    def run(runs, name, **team):
        study = load_study(study_file, [f"campaign.runs={runs}", "campaign.chunk=100"])
        watch, folder = Watch(runs), tmp_path / name
        folder.mkdir()
        with workers(**team) as opened:
            result = run_campaign(plan_campaign(study), folder, opened, watch)
        return watch, result

    return run


def test_two_workers_are_1_8_times_as_fast_as_one_and_memory_stays_flat(timed, ratio):
    alone, _ = timed(FEWER, "one", count=1)
    timed(64, "warm", count=2)
    both, result = timed(RUNS, "two", count=2)
    gain = both.rate() / alone.rate()
    print(
        f"\n{RUNS} movement sets: one worker {alone.rate():.1f} runs/s, two {both.rate():.1f}, "
        f"{gain:.2f} times; in {both.at[-1] - both.at[0]:.0f} s; memory {both.growth():+.1f} MiB "
        f"of {both.bytes[-1] / 2**20:.0f}; {result.failures} failed"
    )
    ratio("campaign: two workers over one", gain, least=1.8)
    assert both.growth() < 50


def test_a_local_cluster_costs_at_most_15_per_cent(timed, ratio):
    from distributed import LocalCluster

    timed(64, "warm", count=2)
    here, one = timed(FEWER, "here", count=2)
    with LocalCluster(
        n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None
    ) as cluster:
        timed(64, "warm cluster", scheduler=cluster.scheduler_address)
        there, other = timed(FEWER, "there", scheduler=cluster.scheduler_address)
    cost = here.rate() / there.rate() - 1
    print(
        f"\n{FEWER} movement sets: joblib {here.rate():.1f} runs/s, Dask {there.rate():.1f}: "
        f"{100 * cost:+.1f} %"
    )
    assert np.array_equal(one.figures, other.figures, equal_nan=True)
    ratio("campaign: joblib's rate over a local cluster's", 1 + cost, most=1.15)
