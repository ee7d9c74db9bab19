"""Moves of some milliseconds, short enough for kernels without the compiler, on every system."""

from __future__ import annotations

import numpy as np
import pytest
from loads import CASE, KEYS, records_of

THERE = '{distance="2 mm", duration="40 ms", rest="10 ms"}'
BACK = '{distance="-2 mm", duration="40 ms", rest="10 ms"}'


def runs(study_file, key, times, repeats):
    moves = f"manoeuvre=[{', '.join([THERE, BACK] * times)}]"
    return records_of(study_file, key, CASE._replace(repeats=repeats), [moves])


@pytest.mark.parametrize("key", KEYS)
def test_what_is_run_in_two_sets_is_what_is_run_in_one(key, study_file):
    """Machine, valves, controller and noise go on where the set before left them."""
    first, second = runs(study_file, key, times=1, repeats=2)
    (whole,) = runs(study_file, key, times=2, repeats=1)
    for name in ("position", "velocity", "force_reference", "pressures"):
        parts = np.concatenate([getattr(first, name), getattr(second, name)])
        np.testing.assert_allclose(parts, getattr(whole, name), rtol=1e-9, atol=1e-12)
    for way in ("drawn", "returned", "delivered", "loss"):
        parts = getattr(first.energies, way) + getattr(second.energies, way)
        assert parts == pytest.approx(getattr(whole.energies, way), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("key", KEYS)
def test_energies_of_a_short_move_close(key, study_file):
    for record in runs(study_file, key, times=1, repeats=2):
        assert record.energies.residual < 1e-9
        assert record.energies.spent["throttling"] > 0
        assert np.ptp(record.position) > 0
