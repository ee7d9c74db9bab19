"""The loop as it runs, over the whole family of the paper's study; run with ``make bench``."""

import time

import numpy as np
import pytest

from mptune.loops.noise import noise_gain
from mptune.loops.sampled import stable_as_sampled
from mptune.robust.grid import first_grid
from mptune.robust.margins import sampled_margins
from mptune.robust.model import LinearModel

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
    model, omega = LinearModel.of(boom), first_grid(0.1, 1000.0)
    loops = model.as_it_runs(model.gains)
    stable = median_time(lambda: stable_as_sampled(loops, model.period))
    margins = median_time(lambda: sampled_margins(omega, loops, model.period))
    noise = median_time(lambda: noise_gain(loops.gains, loops.path))
    print(
        f"\n{loops.plants.number} plants: multipliers {stable:.0f} ms, margins on {len(omega)} "
        f"frequencies {margins:.0f} ms; noise gain {noise:.2f} ms"
    )
