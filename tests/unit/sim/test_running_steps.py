"""Steps of the loop as it runs against the continuous loop, which it nears at a high rate."""

import numpy as np
import pytest

from mptune.loops.family import FamilyLoops
from mptune.params.estimator import place_estimator
from mptune.params.packed import (
    NO_PATH,
    LoopGains,
    MeasurementPath,
    Plants,
    StateEstimator,
)
from mptune.sim.response import load_step, position_step, velocity_step
from mptune.sim.running_steps import StepOf, running_steps

FAST, MASS = 0.5e-3, 24500.0
GAINS = LoopGains(700e3, 13.0, 22.0, 42.0, 0.55, 0.006)
FILTERS = MeasurementPath(FAST, np.exp(-FAST / 0.012), 0.012)
TIME = np.linspace(0, 1.2, 301)
CONTINUOUS = {
    StepOf.VELOCITY: velocity_step,
    StepOf.POSITION: position_step,
    StepOf.LOAD: load_step,
}


def family(path):
    rows = np.array([(MASS, 0.0125, 0.0122, 0.0089, 4 / 7)])
    return FamilyLoops(Plants(*rows.T.copy()), GAINS, path)


@pytest.mark.parametrize("of", StepOf)
def test_at_a_high_rate_the_filtered_loop_is_the_continuous_one(of):
    found = running_steps(family(FILTERS), FAST, TIME, of)
    wanted = CONTINUOUS[of](family(FILTERS), TIME)
    assert found == pytest.approx(wanted, abs=0.01 * np.abs(wanted).max())


@pytest.mark.parametrize("of", [StepOf.VELOCITY, StepOf.POSITION])
def test_an_estimator_that_knows_the_mass_is_not_late(of):
    by = StateEstimator(MASS, *place_estimator(40.0, FAST), 1.0)
    path = MeasurementPath(FAST, 0.0, 1 / 40, by.mass, by.l_1, by.l_2, by.l_3)
    found = running_steps(family(path), FAST, TIME, of, by)
    wanted = CONTINUOUS[of](family(NO_PATH), TIME)
    assert found == pytest.approx(wanted, abs=0.01 * np.abs(wanted).max())


def test_an_estimator_hears_a_load_late():
    by = StateEstimator(MASS, *place_estimator(40.0, FAST), 0.0)
    path = MeasurementPath(FAST, 0.0, 1 / 40, by.mass, by.l_1, by.l_2, by.l_3)
    found = np.abs(running_steps(family(path), FAST, TIME, StepOf.LOAD, by)).max()
    none, filtered = (np.abs(load_step(family(one), TIME)).max() for one in (NO_PATH, FILTERS))
    assert found > 1.05 * min(none, filtered)


def test_no_continuous_step_is_given_with_an_estimator():
    path = MeasurementPath(FAST, 0.0, 1 / 40, MASS, *place_estimator(40.0, FAST))
    with pytest.raises(ValueError, match="running_steps"):
        position_step(family(path), TIME)
