"""The four-chamber cylinder's sixteen forces, and the decision against plain Python."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.systems.secondary_force import (
    ForceWeights,
    Lines,
    cheapest_state,
    force_range,
    four_chambers,
    settled_pressure,
)

CHAMBERS = four_chambers(4e-4, 2e-4)
LINES = Lines(1e6, 12e6, np.array([4.7e-7, 2.4e-7, 1.2e-7, 1.2e-7]))
WEIGHTS = ForceWeights(compression=30.0, switching=100.0, bulk=1.2e9)
STROKE = 0.3


def pressures_of(state):
    return np.array([12e6 if state >> i & 1 else 1e6 for i in range(4)])


def test_sixteen_forces_stand_evenly_spaced():
    forces = np.sort([CHAMBERS.area @ pressures_of(state) for state in range(16)])
    assert np.diff(forces) == pytest.approx(4e-4 * 11e6)
    assert force_range(CHAMBERS, LINES) == pytest.approx((forces[0], forces[-1]))


@pytest.mark.parametrize(("area", "velocity"), [(3e-3, 0.1), (3e-3, -0.1), (-1e-3, 0.05)])
def test_a_settled_chamber_passes_the_flow_that_its_piston_asks_for(area, velocity):
    pressure = settled_pressure(12e6, area, velocity, 4e-7)
    drop = 12e6 - pressure
    assert 4e-7 * np.copysign(np.sqrt(abs(drop)), drop) == pytest.approx(area * velocity)


def plainly(wanted, position, velocity, pressures, present):
    costs = []
    for state in range(16):
        force, spent = 0.0, 0.0
        for i, area in enumerate(CHAMBERS.area):
            line = 12e6 if state >> i & 1 else 1e6
            flow = area * velocity / LINES.coefficient[i]
            pressure = max(line - np.sign(flow) * flow**2, 0)
            volume = 2e-4 + abs(area) * (position if area > 0 else STROKE - position)
            force += area * pressure
            spent += volume * (pressure - pressures[i]) ** 2 / 2 / WEIGHTS.bulk
        switches = 2 * (state ^ present).bit_count()
        costs.append(abs(wanted - force) + 30 * spent + 100 * switches)
    return int(np.argmin(costs))


def test_the_cheapest_state_is_that_of_plain_python():
    random = np.random.default_rng(3)
    seen = set()
    for _ in range(100):
        wanted, position = random.uniform(-2e4, 4.5e4), random.uniform(0.02, 0.28)
        velocity, present = random.uniform(-0.1, 0.1), int(random.integers(16))
        pressures = pressures_of(present) + random.normal(0, 1e6, 4)
        found = cheapest_state(
            wanted, position, velocity, pressures, present, CHAMBERS, STROKE, LINES, WEIGHTS
        )
        assert found == plainly(wanted, position, velocity, pressures, present)
        seen.add(found)
    assert len(seen) > 10
