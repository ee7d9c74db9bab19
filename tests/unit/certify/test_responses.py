"""An estimator's responses and an alias's shares as balls, against mpmath at random members."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from mptune.certify.estimated import floor_of, responses
from mptune.certify.shares import over_alias, share_of
from mptune.params.estimator import place_estimator
from mptune.params.packed import MeasurementPath

FAST, BANDWIDTH = 5e-4, 57.0
PATH = MeasurementPath(FAST, 0.0, 1 / BANDWIDTH, 24_500.0, *place_estimator(BANDWIDTH, FAST))
NAMES = (
    "late", "over_s", "speed_of_force", "place_of_force", "speed_of_place", "place_of_place",
    "below", "ahead",
)  # fmt: skip


def exact(omega):
    """Return the responses times Δ at one frequency, to many digits."""
    with mpmath.workdps(40):
        s, time = mpmath.mpc(0, omega), mpmath.mpf(FAST)
        w = mpmath.exp(-s * time)
        slope = (1 - w) / time
        first, second, third = (mpmath.mpf(one) / time for one in (PATH.l_1, PATH.l_2, PATH.l_3))
        place = first * slope**2 + second * w * slope + third * w * (1 + w) / 2
        ahead = slope + first * w - time * second / 2
        return {
            "late": w,
            "over_s": slope / s,
            "speed_of_force": slope * ahead,
            "place_of_force": (1 - mpmath.mpf(PATH.l_1)) * slope * (1 + w) / 2,
            "speed_of_place": second * slope + third * w,
            "place_of_place": place,
            "below": slope**3 + first * w * slope**2 + second * w * slope + third * w * (1 + w) / 2,
            "ahead": ahead,
        }


def assert_enclosed(one, of, omega, half, rng):
    """Compare value, members and slope of a dual with an exact function."""
    assert abs(complex(of(omega)) - one.value) <= one.error + 1e-300
    for member in omega + half * rng.uniform(-1, 1, 4):
        assert abs(complex(of(member)) - one.value) <= one.spread * (1 + 1e-12)
        step = 1e-6 * max(abs(member), 1.0)
        slope = (of(member + step) - of(member - step)) / (2 * mpmath.mpf(step))
        away = abs(complex(slope) - one.slope)
        assert away <= one.slope_spread + 1e-9 * abs(one.slope) + 1e-7 * abs(one.value)


@pytest.mark.parametrize("folded", [0, 1])
def test_responses_are_enclosed(folded):
    rng = np.random.default_rng(3)
    for _ in range(12):
        omega = float(10 ** rng.uniform(0, 3))
        half = omega * float(10 ** rng.uniform(-4, -1))
        found = responses(PATH, omega, half, folded)
        assert abs(exact(omega)["below"]) >= floor_of(PATH)
        for name in NAMES:
            assert_enclosed(
                getattr(found, name), lambda at, name=name: exact(at)[name], omega, half, rng
            )


@pytest.mark.parametrize("sign", [1, -1])
def test_the_shares_of_an_alias_are_enclosed(sign):
    rng = np.random.default_rng(4)
    for count in (1, 2, 7):
        shift = sign * count * 2 * np.pi / 0.01
        for _ in range(5):
            omega, half = rng.uniform(1, 300), 10 ** rng.uniform(-3, 1)
            share, over = share_of(omega, half, shift), over_alias(omega, half, shift)
            assert_enclosed(share, lambda x, at=shift: mpmath.mpf(x) / (x + at), omega, half, rng)
            assert_enclosed(over, lambda x, at=shift: 1 / mpmath.mpc(0, x + at), omega, half, rng)
    assert share_of(30.0, 1.0, 0.0).value == 1
