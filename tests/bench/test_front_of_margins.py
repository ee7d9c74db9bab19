"""What a disk margin costs with a state estimator, as ``mptune tune --along disk_margin`` finds it.

The front of ``studies/boom-estimator`` from its own gains on, at its own requirements: no more
compliance than published and less than half the published noise. Each point then runs on the
machine with ``MPTUNE_BENCH_SETS`` movement sets that no search has seen. Run with ``make trials``.
"""

import os
import time

import numpy as np
import pytest

from mptune.job.margin_front import on_the_machine
from mptune.params.load import load_study
from mptune.robust.model import LinearModel
from mptune.tune.margin_front import margin_front
from mptune.tune.space import Choice

pytestmark = [pytest.mark.bench, pytest.mark.trial]

SETS, POINTS = int(os.environ.get("MPTUNE_BENCH_SETS", "4")), 7
PUBLISHED_COMPLIANCE, PUBLISHED_NOISE = 3.171e-7, 2044.5  # m/N, N
REACHED = 0.7  # at the study's 700 N of noise
LONGEST = 150.0  # s of one processor for the search and its certificates


def test_index_rises_with_the_margin(root):
    run = [f"verification.repeats={SETS + 1}", "verification.seeds=[101]"]
    study = load_study(root / "studies/boom-estimator/study.toml", run)
    begin = time.process_time()
    points = margin_front(study, POINTS, start=Choice.of(LinearModel.of(study)))
    spent = time.process_time() - begin
    print(f"\n{len(points)} points in {spent:.0f} s of one processor")
    rows = [on_the_machine(study, one) for one in points]
    for one, row in zip(points, rows, strict=True):
        machine = " / ".join(f"{each['performance_index_ms']:.2f}" for each in row["by_mass"])
        figures = one.figures
        print(
            f"disk margin {figures.disk_margin:.3f}, guaranteed {one.guaranteed:.3f}; compliance "
            f"{figures.peak_compliance / PUBLISHED_COMPLIANCE:.2f} of published, noise "
            f"{one.noise_force:.0f} N; linear index {1e3 * figures.tracking:.2f} ms; machine "
            f"{machine} ms"
        )
        assert figures.disk_margin >= one.asked * (1 - 1e-3)
        assert figures.peak_compliance <= PUBLISHED_COMPLIANCE
        assert one.noise_force <= 0.5 * PUBLISHED_NOISE
        assert one.guaranteed > 0
    assert len(points) >= 6
    assert points[-1].figures.disk_margin >= REACHED
    linear = [one.figures.tracking for one in points]
    assert linear == sorted(linear)
    assert np.isfinite([row["performance_index_ms"] for row in rows]).all()
    assert spent <= LONGEST
