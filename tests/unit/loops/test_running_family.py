"""The loops as they run, kept for a search: the same loop gains, and roots inside the circle."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mptune.loops.family import FamilyLoops
from mptune.loops.running import inside_unit_circle, running_family, runs_stable, sampled_at
from mptune.loops.sampled import sampled_controller, sampled_loop, stable_as_sampled
from mptune.params.packed import LoopGains, MeasurementPath, Plants

PERIOD, FAST = 0.01, 0.0005
PATH = MeasurementPath(FAST, float(np.exp(-FAST / 0.012)), 0.012)
GAINS = LoopGains(700e3, 13.0, 22.0, 42.0, 0.55, 0.006)
PLANTS = Plants(
    np.array([24.5e3, 49e3, 24.5e3]), np.array([0.014, 0.0123, 0.005]),
    np.array([0.0122, 0.003, 0.0]), np.array([0.0119, 0.0101, 0.0]), np.full(3, 4 / 7),
)  # fmt: skip


@pytest.fixture(scope="module")
def family():
    return running_family(0.05, PLANTS, PATH, PERIOD)


def test_what_is_kept_makes_the_sampled_loop(family):
    assert family.omega[0] == pytest.approx(0.05)
    assert family.omega[-1] == pytest.approx(np.pi / PERIOD)
    for n in range(PLANTS.number):
        plant = sampled_at(family, n)
        for f in range(0, len(family.omega), 40):
            s = 1j * family.omega[f]
            heard = family.velocity_at[n, f]
            heard += sampled_controller(s, GAINS, PERIOD) * family.position_at[n, f]
            whole = sampled_loop(s, plant, GAINS, PERIOD)
            assert GAINS.k_p_vel * heard == pytest.approx(whole, rel=1e-12)


@given(
    st.lists(st.complex_numbers(max_magnitude=1.3), min_size=1, max_size=6),
    st.lists(st.floats(-1.3, 1.3), max_size=4),
)
def test_roots_inside_the_circle_are_told_from_others(pairs, single):
    roots = np.array([*pairs, *np.conj(pairs), *single])
    radius = np.abs(roots).max()
    assume(abs(radius - 1) > 1e-3)
    polynomial = np.ascontiguousarray(3.0 * np.poly(roots).real)
    assert inside_unit_circle(polynomial) == (radius < 1)


@pytest.mark.parametrize("factor", [0.3, 1.0, 1.2, 1.3, 2.0, 5.0])
def test_stability_is_that_of_the_multipliers(family, factor):
    gains = GAINS._replace(k_p_vel=factor * GAINS.k_p_vel)
    stable, sure = stable_as_sampled(FamilyLoops(PLANTS, gains, PATH), PERIOD)
    assert sure.all()
    assert [runs_stable(family, n, gains) for n in range(3)] == stable.tolist()
