"""Encirclements: against the sweep's stability, and against the turning of a sampled curve."""

import numpy as np
import pytest

from mptune.loops.broken import FORCE, VELOCITY
from mptune.robust.curves import loop_curves
from mptune.robust.encirclements import encirclements
from mptune.robust.sweep import sweep

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes


@pytest.fixture(scope="module")
def swept(load_boom):
    return sweep(load_boom(corners=True, twice=True))


@pytest.fixture(scope="module")
def counts(swept):
    return {(one.loop, one.path): one for one in encirclements(swept)}


def test_counts_agree_with_the_sweep_s_stability(swept, counts):
    places = {(loop, path) for loop in (VELOCITY, FORCE) for path in ("none", "filters")}
    assert set(counts) == places
    for (loop, path), one in counts.items():
        family = swept.family(path)
        count = int((~family.velocity_stable).sum())
        if loop == FORCE:
            count = family.unstable_count
        assert one.plants == len(family.stable)
        assert one.undecided_plants == 0
        assert one.unstable_plants == count
        assert (one.most > 0) == (count > 0)
        assert one.nominal == 0


def test_published_gains_have_two_unstable_poles_with_the_path_and_none_without(counts):
    assert counts[FORCE, "none"].worst == 0
    assert counts[FORCE, "filters"].worst == 2


@pytest.mark.parametrize("name", ["none", "filters"])
def test_the_worst_plant_s_count_is_the_turning_of_its_curve(swept, counts, name):
    """From c/s³ at −3π/2 to 1 the angle grows by 3π/2, less π for each unstable pole."""
    model, omega = swept.model, np.geomspace(1e-3, 3e4, 400_000)
    loops = model.loops(swept.gains, model.path_of(name), model.plant(swept.position.at))
    curve = loop_curves(FORCE, omega, loops)[0]
    angle = np.unwrap(np.angle(1 + curve))
    poles = 1.5 - (angle[-1] - angle[0]) / np.pi
    assert poles == pytest.approx(counts[FORCE, name].worst, abs=0.05)
