"""The report's table of drivers: how far each parameter's kinder end lies below the worst case."""

from __future__ import annotations

import pytest

from mptune.report.blocks import Tabular
from mptune.report.content.loops import inequalities
from mptune.report.results import Results
from mptune.robust.one_at_a_time import one_at_a_time
from mptune.robust.sweep import sweep

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes


@pytest.fixture(scope="module")
def results(load_boom):
    study = load_boom(corners=True)
    swept = sweep(study)
    return Results(study, swept, swept, study.study.feedforward, influences=one_at_a_time(swept))


def driver_rows(results):
    """Return the rows of the table by their columns' headings."""
    for block in inequalities(results).blocks:
        headings = [column.text for column in getattr(block, "columns", ())]
        if "lower by" in headings:
            return [dict(zip(headings, row, strict=True)) for row in block.rows]
    raise AssertionError("no table of drivers")


def test_lower_by_is_what_the_lesser_ratio_lacks_of_the_worst(results):
    rows = driver_rows(results)
    assert len(rows) == len(results.influences) == 8
    shares = []
    for row, one in zip(rows, results.influences, strict=True):
        worst = getattr(results.sweep, one.condition).worst_ratio
        kinder = min(float(row["Ratio, low end"]), float(row["high end"]))
        shares.append(float(row["lower by"].removesuffix(" %")))
        assert shares[-1] == pytest.approx(100 * (1 - kinder / worst), abs=0.06)
    assert max(shares) > 10  # the delay drives both


def test_nothing_is_said_where_no_driver_was_sought(results):
    bare = Results(results.study, results.sweep, results.published, results.feedforward)
    assert sum(isinstance(block, Tabular) for block in inequalities(bare).blocks) == 1
