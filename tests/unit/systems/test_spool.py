"""The mobile valve's parts, by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mptune.systems.spool import (
    Spool,
    command_for,
    delayed,
    inlet_flow,
    opening_of,
    spool_rates,
)

VALVE = Spool(
    inlet=1e-6,
    outlet=3e-7,
    compensated=0.7e6,
    frequency=44.0,
    damping=0.8,
    dead_time=0.01,
    rate=7.0,
    play=0.01,
    dead_band=0.2,
    known_band=0.2,
    transition=1e5,
)
RATED = VALVE.inlet * math.sqrt(VALVE.compensated)


@pytest.mark.parametrize(
    ("place", "opening"),
    [(0.0, 0.0), (0.19, 0.0), (-0.19, 0.0), (0.6, 0.5), (-0.6, -0.5), (1.0, 1.0), (1.2, 1.0)],
)
def test_nothing_opens_within_the_dead_band(place, opening):
    assert opening_of(place, VALVE) == pytest.approx(opening)


@pytest.mark.parametrize("flow", [-0.9 * RATED, -0.1 * RATED, 0.0, 0.02 * RATED, RATED])
def test_a_known_dead_band_is_stepped_across_exactly(flow):
    opening = opening_of(command_for(flow, VALVE), VALVE)
    found = math.copysign(inlet_flow(abs(opening), 10e6, 5e6, VALVE), flow)
    assert found == pytest.approx(flow, abs=1e-12 * RATED)


def test_what_is_not_known_of_the_dead_band_is_missing_from_the_flow():
    valve = VALVE._replace(known_band=0.15)
    opening = opening_of(command_for(0.5 * RATED, valve), valve)
    assert opening == pytest.approx(0.5 - 0.05 / 0.8)
    assert opening_of(command_for(0.01 * RATED, valve), valve) == 0


def test_the_compensator_holds_its_pressure_and_no_flow_runs_back():
    assert inlet_flow(1.0, 10e6, 5e6, VALVE) == pytest.approx(RATED)
    assert inlet_flow(1.0, 20e6, 5e6, VALVE) == pytest.approx(RATED)
    assert inlet_flow(1.0, 5.3e6, 5e6, VALVE) == pytest.approx(VALVE.inlet * math.sqrt(0.3e6))
    assert inlet_flow(1.0, 4e6, 5e6, VALVE) == 0


def test_the_spool_is_of_second_order_and_its_rate_limited():
    rate, pull = spool_rates(0.5, 0.2, 1.0, VALVE)
    assert rate == 1.0
    assert pull == pytest.approx(44**2 * 0.3 - 2 * 0.8 * 44 * 1.0)
    assert spool_rates(1.0, 0.0, 7.0, VALVE) == (7.0, 0.0)
    assert spool_rates(-1.0, 0.0, -7.5, VALVE) == (-7.0, 0.0)
    assert spool_rates(-1.0, 0.0, 7.5, VALVE)[1] < 0


def test_a_command_comes_out_after_as_many_ticks_as_the_ring_holds():
    ring = np.zeros(3)
    found = [delayed(ring, tick, float(tick + 1)) for tick in range(6)]
    assert found == [0, 0, 0, 1, 2, 3]
