"""Brackets from verdicts that are certain, and from some that are not."""

from __future__ import annotations

import math

import pytest

from mptune.certify.bracket import bracket
from mptune.certify.result import Stability

STABLE, UNSTABLE, UNDECIDED = Stability.STABLE, Stability.UNSTABLE, Stability.UNDECIDED


def limited(safe, failing):
    """Return a verdict: safe up to one number, failing from another on, open between."""
    asked = []

    def verdict(value, lower):
        assert lower <= safe
        asked.append(value)
        if value <= safe:
            return STABLE, None, 1
        return (UNSTABLE, None, 1) if value >= failing else (UNDECIDED, None, 1)

    return verdict, asked


@pytest.mark.parametrize("limit", [0.0123, 0.7, 1.0, 3.3, 77.0])
@pytest.mark.parametrize("tolerance", [1e-2, 1e-5])
def test_a_sharp_limit_is_enclosed(limit, tolerance):
    verdict, asked = limited(limit, limit * (1 + 1e-12))
    found = bracket(verdict, 1.0, tolerance, 1e-3, 128.0)
    assert found.closed
    assert found.lower <= limit <= found.upper <= (1 + tolerance) * found.lower
    assert found.boxes == len(asked) < 60


def test_what_cannot_be_decided_stays_between():
    verdict, _ = limited(2.0, 2.5)
    found = bracket(verdict, 1.0, 1e-3, 1e-3, 128.0)
    assert not found.closed
    assert 2.0 / 1.002 <= found.lower <= 2.0
    assert 2.5 <= found.upper <= 2.5 * 1.002


def test_no_limit_within_what_is_asked():
    verdict, _ = limited(1e9, 2e9)
    found = bracket(verdict, 1.0, 1e-2, 1e-3, 128.0)
    assert found.lower == 128.0
    assert found.upper == math.inf
    assert found.closed


def test_nothing_is_safe():
    verdict, _ = limited(0.0, 1e-12)
    found = bracket(verdict, 1.0, 1e-2, 1e-3, 128.0)
    assert found.lower == 0
    assert found.upper <= 1e-3


def test_nothing_is_known():
    verdict, _ = limited(0.0, 1e12)
    found = bracket(verdict, 1.0, 1e-2, 1e-3, 128.0)
    assert not found.closed
    assert found.lower == 0
    assert found.upper == math.inf
