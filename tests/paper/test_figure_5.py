"""Fig. 5: the four panels of the published gains."""

import numpy as np
import pytest

from mptune.loops.family import FamilyLoops, plants_of
from mptune.params.pack import pack_gains
from mptune.params.packed import NO_PATH
from mptune.sim.response import position_step, velocity_step

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes


def test_step_responses_of_the_whole_family_settle_on_the_reference(load_boom):
    study = load_boom()
    loops = FamilyLoops(plants_of(study), pack_gains(study.study.gains), NO_PATH)
    time = np.linspace(0, 4, 801)
    velocity = velocity_step(loops, time)
    position = position_step(loops, time)
    print(
        f"overshoot over the family: velocity {velocity.max() - 1:.3f}, "
        f"position {position.max() - 1:.3f}"
    )
    np.testing.assert_allclose(velocity[:, -1], 1, atol=1e-3)
    np.testing.assert_allclose(position[:, -1], 1, atol=1e-2)
    assert velocity.max() < 1.5
    assert position.max() < 1.5


def test_nothing_moves_before_the_dead_time_is_over(load_boom):
    study = load_boom()
    plants = plants_of(study)
    time = np.linspace(0, float(plants.delay.min()), 50)
    loops = FamilyLoops(plants, pack_gains(study.study.gains), NO_PATH)
    found = position_step(loops, time)
    assert np.all(found == 0)


def test_worst_plant_with_measurement_path_grows_as_its_encirclement_count_says(load_boom):
    """The plant that the count with path calls unstable does grow in time, and others do not."""
    from mptune.params.pack import pack_filters
    from mptune.params.packed import Plants

    study = load_boom()
    path = pack_filters(study.study.controller)
    plants = Plants(
        np.array([24500.0, 49000.0]),
        np.array([0.0215, 0.011]),
        np.array([0.0122, 0.0001]),
        np.array([0.0119, 0.0001]),
        np.full(2, study.study.share_a),
    )
    time = np.linspace(0, 12, 2401)
    loops = FamilyLoops(plants, pack_gains(study.study.gains), path)
    found = np.abs(position_step(loops, time) - 1)
    early, late = found[:, (time > 2) & (time < 4)].max(axis=1), found[:, time > 10].max(axis=1)
    assert late[0] > 1.5 * early[0]
    assert late[1] < early[1]
