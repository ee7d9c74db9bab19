"""The loop as it runs, over the whole family of the paper's study; run with ``make bench``."""

import time

import numpy as np
import pytest

from mptune.loops.family import plants_of
from mptune.loops.noise import noise_gain
from mptune.loops.sampled import stable_as_sampled
from mptune.params.pack import pack_filters, pack_gains
from mptune.robust.grid import first_grid
from mptune.robust.margins import sampled_margins

pytestmark = pytest.mark.bench


def median_time(work, runs=5):
    work()  # compile, or load from the cache
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return 1e3 * float(np.median(times))


def test_the_whole_family_as_it_runs(boom):
    plants, gains = plants_of(boom), pack_gains(boom.study.gains)
    path, period = (
        pack_filters(boom.study.controller),
        boom.study.controller.sampling_period,
    )
    share_a, omega = boom.study.cylinder.share_a, first_grid(0.1, 1000.0)
    stable = median_time(lambda: stable_as_sampled(plants, share_a, gains, path, period))
    margins = median_time(lambda: sampled_margins(omega, plants, share_a, gains, path, period))
    noise = median_time(lambda: noise_gain(gains, path))
    print(
        f"\n{len(plants.mass)} plants: multipliers {stable:.0f} ms, margins on {len(omega)} "
        f"frequencies {margins:.0f} ms; noise gain {noise:.2f} ms"
    )
