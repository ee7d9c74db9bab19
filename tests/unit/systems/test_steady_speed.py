"""The steady-state decision on speed: physics of the steady state, all pairs in plain Python."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from mptune.systems.steady_speed import SpeedWeights, cheapest_pair, settled
from mptune.systems.switching import ones

EDGE = 9.4e-7
AREAS = 5e-3, 3.8e-3
WEIGHTS = SpeedWeights(back_pressure=3e6, pressure=2e-9, switching=3e-4)


@pytest.mark.parametrize("number", [0, 1, 2, 3, 21, 31])
def test_ones_are_the_set_bits(number):
    assert ones(number) == number.bit_count()


@pytest.mark.parametrize("force", [-8e3, 0.0, 12e3])
def test_a_settled_speed_balances_flows_and_forces(force):
    supply, inlet, outlet = 8e6, 0.3 * EDGE, 0.5 * EDGE
    speed, fed, drained = settled(supply, force, *AREAS, inlet, outlet)
    assert inlet * math.sqrt(supply - fed) == pytest.approx(AREAS[0] * speed)
    assert outlet * math.sqrt(drained) == pytest.approx(AREAS[1] * speed)
    assert AREAS[0] * fed - AREAS[1] * drained == pytest.approx(force, abs=1e-6)


def test_a_load_beyond_the_supply_is_not_moved():
    assert settled(2e6, 2e4, *AREAS, EDGE, EDGE)[0] == 0


def plainly(speed, supply, force, present_in, present_out, others):
    best = (
        speed + WEIGHTS.switching * (present_in.bit_count() + present_out.bit_count() + others),
        (0, 0),
    )
    for pair in itertools.product(range(1, 32), repeat=2):
        inlet, outlet = (EDGE * level / 31 for level in pair)
        force_free = AREAS[0] ** 3 / inlet**2 + AREAS[1] ** 3 / outlet**2
        square = max(AREAS[0] * supply - force, 0) / force_free
        fed, drained = (
            supply - AREAS[0] ** 2 * square / inlet**2,
            AREAS[1] ** 2 * square / outlet**2,
        )
        if square == 0:
            fed, drained = supply, 0.0
        changed = (pair[0] ^ present_in).bit_count() + (pair[1] ^ present_out).bit_count() + others
        cost = abs(speed - math.sqrt(square)) + WEIGHTS.switching * changed
        cost += WEIGHTS.pressure * abs(min(fed, drained) - WEIGHTS.back_pressure)
        best = min(best, (cost, pair))
    return best[1]


def test_the_cheapest_pair_is_that_of_plain_python():
    random = np.random.default_rng(4)
    for _ in range(40):
        speed, supply = random.uniform(0, 0.12), random.uniform(2e6, 12e6)
        force = random.uniform(-1e4, 3e4)
        now = [int(one) for one in random.integers(0, 32, 2)]
        others = int(random.integers(0, 6))
        found = cheapest_pair(speed, supply, force, *AREAS, EDGE, *now, others, WEIGHTS)
        assert found == plainly(speed, supply, force, *now, others)
