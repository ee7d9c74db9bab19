"""What is believed of a measured response beyond the ends of its band, and no more than that."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.loops.broken import FORCE, VELOCITY
from mptune.params.packed import NO_PATH, LoopGains
from mptune.robust.measured import ForceResponse, Members
from mptune.robust.measured_loops import count_members

MASS = 25e3
CORNER = 10.0  # rad/s, where the loop at F_ref nearly vanishes: √K_I,pos of an I-term alone
INTEGRAL = LoopGains(12 * MASS * CORNER, 0.0, CORNER**2, 42.0, 0.55, 0.006)
VELOCITY_ALONE = LoopGains(20 * MASS, 0.0, 0.0, 42.0, 0.55, 0.006)


def decided(which, gains, first, last, delay):
    """Return whether a count is decided of a finely measured pure delay from first to last."""
    omega = np.geomspace(first, last, 500)
    response = ForceResponse("rig", omega, np.exp(-1j * omega * delay))
    members = Members((response,), np.array([MASS]), instead=False)
    return bool(count_members(which, members, gains, NO_PATH).decided[0])


@pytest.mark.parametrize(("turned", "expected"), [(1.00, False), (0.95, True)])
def test_below_the_band_the_force_may_be_off_by_half(turned, expected):
    """L = K/(ms) (1 + K_I/s²) e^{−sd} dips to −1 below the band, and is above 2 at its start.

    How near it passes, over its own size, is what the continued response may be off by.
    """
    delay, first = turned / CORNER, 1.7 * CORNER
    below = 1j * np.geomspace(0.1, first, 100_000)
    loop = INTEGRAL.k_p_vel / (MASS * below) * (1 + INTEGRAL.k_i_pos / below**2)
    loop *= np.exp(-below * delay)
    nearness = np.min(np.abs(1 + loop) / np.abs(loop))
    print(f"delay {1e3 * delay:.0f} ms: the loop passes {nearness:.3f} of itself from −1")
    assert 0.48 < nearness < 0.54
    assert bool(nearness > 0.5) is expected
    assert abs(loop[-1]) > 2
    assert decided(FORCE, INTEGRAL, first, 600.0, delay) is expected


@pytest.mark.parametrize(("last", "expected"), [(0.45, True), (0.55, False), (0.9, False)])
def test_at_the_band_s_end_the_loop_has_to_be_below_one_half(last, expected):
    """L = 20/s: at 20/last rad/s it is ``last``."""
    assert decided(VELOCITY, VELOCITY_ALONE, 1.0, 20 / last, 0.01) is expected


@pytest.mark.parametrize(("first", "expected"), [(2.2, True), (1.8, False)])
def test_at_the_band_s_start_the_loop_has_to_be_above_two(first, expected):
    assert decided(VELOCITY, VELOCITY_ALONE, 20 / first, 400.0, 0.01) is expected
