"""The boom tunes on the loop as it runs, and keeps what its published gains keep."""

import pytest

from mptune.params.load import load_study
from mptune.tune.result import TuneStatus
from mptune.tune.tuner import tune

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes


@pytest.fixture(scope="module")
def tuned(study_file):
    return tune(load_study(study_file, ["uncertainty.points=2"]))


def test_it_tracks_better_as_it_runs_within_the_published_noise_and_ratios(tuned):
    before, after = tuned.figures_before.tracking, tuned.figures.tracking
    print(f"tracking index as it runs {1e3 * before:.2f} -> {1e3 * after:.2f} ms")
    assert tuned.status is TuneStatus.OPTIMAL
    assert tuned.sweep.satisfied
    assert after < 0.95 * before
    assert tuned.sweep.noise_gain <= 34.1e6
    assert tuned.gains.k_i_pos >= 22 * (1 - 1e-9)


def test_it_is_no_nearer_to_instability_than_the_published_gains(tuned):
    """Their gain margin as they run is 1.24, their disk margin 0.12."""
    margin, _ = tuned.sweep.family("sampled").worst("gain_margin", 2)
    disk, _ = tuned.sweep.family("sampled").worst("disk_margin", 2)
    print(f"gain margin {margin:.3f}, disk margin {disk:.3f}")
    assert margin > 1.24
    assert disk > 0.122
