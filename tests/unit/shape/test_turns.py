"""Encirclements of sampled loops against the roots of the same loops."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mptune.shape.turns import count_sampled, doubts

OMEGA = np.geomspace(1e-5, 1e5, 6000)


def loop_and_poles(gain, zeros, poles, integrators):
    """Return L on the grid and the number of closed-loop poles in the right half plane."""
    top = gain * np.real(np.poly(zeros)) if len(zeros) else np.array([gain])
    bottom = np.real(np.poly([*poles, *([0.0] * integrators)]))
    s = 1j * OMEGA
    closed = np.roots(np.polyadd(top, bottom))
    return np.polyval(top, s) / np.polyval(bottom, s), closed


@given(
    gain=st.floats(-50, 50),
    zeros=st.lists(st.floats(-5, 5), max_size=1),
    poles=st.lists(st.floats(-5, 5), min_size=2, max_size=3),
    integrators=st.integers(0, 2),
)
def test_count_is_that_of_the_roots(gain, zeros, poles, integrators):
    assume(all(abs(one) > 0.05 for one in [*poles, *zeros]))
    assume(abs(gain) > 0.1)
    assume(all(abs(zero - pole) > 0.05 for zero in zeros for pole in poles))
    loop, closed = loop_and_poles(gain, zeros, poles, integrators)
    assume(np.abs(closed.real).min() > 1e-3)
    count = count_sampled(loop, integrators, sum(pole > 0 for pole in poles))
    assert count.decided[0]
    assert count.unstable[0] == np.sum(closed.real > 0)


def test_rows_are_counted_one_by_one():
    s = 1j * OMEGA
    loops = np.stack([gain / (s * (s + 1) ** 2) for gain in (1.0, 1.9, 2.1, 30.0)])
    assert count_sampled(loops, 1).unstable.tolist() == [0, 0, 2, 2]


@pytest.mark.parametrize(
    ("reason", "places", "integrators"),
    [
        ("tail", slice(0, 3000), 1),
        ("start", slice(3200, None), 1),
        ("start", slice(None), 2),
        ("coarse", slice(None, None, 900), 1),
    ],
)
def test_what_a_grid_cannot_tell_is_refused(reason, places, integrators):
    s = 1j * OMEGA[places]
    loop = 5e3 / (s * (0.01 * s + 1) ** 2)[None] if reason == "coarse" else 1.9 / (s * (s + 1) ** 2)
    count = count_sampled(loop, integrators)
    assert not count.decided.any()
    assert doubts(loop, integrators)[reason].all()
