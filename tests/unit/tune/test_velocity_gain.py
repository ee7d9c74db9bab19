"""The velocity gain where no requirement limits it: by the nominal loop's own stability."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.loops.broken import VELOCITY
from mptune.loops.stability import count_unstable_poles
from mptune.robust.model import LinearModel
from mptune.tune.velocity import largest_velocity_gain

CERTAIN = (
    'uncertainty.mass=["24.5 t", "24.5 t"]',
    'uncertainty.delay=["11 ms", "11 ms"]',
    'uncertainty.tau_a=["0 s", "0 s"]',
    'uncertainty.tau_b=["0 s", "0 s"]',
)


def model_of(load_boom, path):
    """Return the model of a family that holds the nominal plant alone."""
    return LinearModel.of(load_boom(f'model.measurement_path="{path}"', *CERTAIN))


def limit_of(model):
    """Return the gain [N s/m] at which the nominal velocity loop turns unstable, by halving."""
    low, high = 1e5, 1e8
    for _ in range(40):
        middle = np.sqrt(low * high)
        gains = model.gains._replace(k_p_vel=middle)
        loop = model.nominal_loop(gains, which=VELOCITY)
        low, high = (middle, high) if count_unstable_poles(loop).stable[0] else (low, middle)
    return low


def test_without_uncertainty_it_is_half_of_what_the_nominal_loop_bears(load_boom):
    model = model_of(load_boom, "none")
    found = largest_velocity_gain(model)
    print(f"{found.k_p_vel / 1e3:.1f} kN s/m of {limit_of(model) / 1e3:.1f} kN s/m")
    assert found.limited_by == "nominal stability"
    assert found.k_p_vel == pytest.approx(24500 * np.pi / (4 * 0.011), rel=1e-12)
    assert found.k_p_vel == pytest.approx(limit_of(model) / 2, rel=1e-6)


def test_with_the_measurement_path_it_is_still_less(load_boom):
    """The path's lags are taken as delays, though a filter of 12 ms attenuates as well."""
    model = model_of(load_boom, "filters")
    share = largest_velocity_gain(model).k_p_vel / limit_of(model)
    print(f"{share:.3f} of the gain at which the nominal loop turns unstable")
    assert 0.3 < share < 0.5


def test_a_stated_bound_below_that_limits_it_first(load_boom):
    found = largest_velocity_gain(model_of(load_boom, "none"), upper=8e5)
    assert (found.k_p_vel, found.limited_by) == (8e5, "bounds")
