"""Measured responses that once hung the sweep or were trusted wrongly.

``response-too-short.csv`` ends at 40 rad/s; ``response-unstable.csv`` has 60 ms of dead time. The
others are one plant with 80 ms of dead time and a lag of 4 ms, at 200 points and at 9 points
76 rad/s apart, each with its phase unwrapped: the velocity loop alone crosses at 28.6 rad/s with
−221°.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from mptune.robust.chain import chain
from mptune.robust.result import Status
from mptune.robust.sweep import sweep

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

CASES = Path(__file__).parent / "cases"


@pytest.mark.parametrize("place", ["beside", "instead"])
@pytest.mark.parametrize(
    ("case", "status", "undecided"),
    [
        ("too-short", Status.UNDECIDED, True),
        ("unstable", Status.UNSTABLE, False),
        ("80ms-fine", Status.UNSTABLE, False),
        ("80ms-coarse", Status.UNDECIDED, True),
    ],
)
def test_a_response_is_stable_only_where_that_is_certain(load_boom, case, place, status, undecided):
    file = (CASES / f"response-{case}.csv").as_posix()
    study = load_boom(
        f'uncertainty.measured=["{file}"]',
        f'uncertainty.measured_place="{place}"',
        corners=True,
    )
    found = sweep(study)
    assert not found.satisfied
    lightest = study.uncertainty.mass[0]
    for family in found.families:
        members = slice(len(family.stable) - len(family.responses), None)
        masses = family.plants.mass[members]
        assert not family.stable[members][masses == lightest].any()
        assert family.decided[members][masses == lightest].any() != undecided
    check = next(one for one in found.checks if one.key == "unstable_plants")
    assert check.status is status
    for link in chain(found)[1:3]:
        assert not link.factor > 1  # NaN where it cannot be told
