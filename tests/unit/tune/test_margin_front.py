"""Tracking against disk margin: what a margin costs, from the search to the report."""

import numpy as np
import pytest

from mptune.certify.stability import box_stability
from mptune.figures.margin_front import index_over_margin
from mptune.figures.style import to_svg
from mptune.job.leftovers import keep, leftovers
from mptune.job.margin_front import on_the_machine
from mptune.params.pack import pack_gains
from mptune.report.blocks import Figure
from mptune.report.content.tradeoff import margin_points, margins
from mptune.report.results import Results
from mptune.robust.certificates import certified_problem
from mptune.robust.model import LinearModel
from mptune.tune.margin_front import margin_front
from mptune.tune.space import Choice

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

SHORT = (
    "verification.repeats=1",
    "verification.seeds=[1]",
    'verification.masses=["24500 kg"]',
    'verification.oil_bulk_moduli=["1200 MPa"]',
)


@pytest.fixture(scope="module")
def found(load_boom):
    return margin_front(load_boom(*SHORT, corners=True), 2, 0.3)


def test_a_larger_margin_is_paid_for_in_tracking(found, load_boom):
    margin = [one.figures.disk_margin for one in found]
    index = [one.figures.tracking for one in found]
    assert len(found) == 2
    assert margin == sorted(margin)
    assert index == sorted(index)
    assert margin[-1] == pytest.approx(0.3, rel=0.02)
    for one in found:
        assert one.guaranteed <= one.figures.disk_margin * (1 + 1e-9)
        assert one.figures.disk_margin >= one.asked * (1 - 1e-3)
    model = LinearModel.of(found[-1].put_over(load_boom(corners=True)))
    problem = certified_problem(model, model.gains)
    assert box_stability(problem, "sampled").status == "stable"


def test_a_known_best_tracking_is_where_the_front_starts(found, load_boom):
    best = Choice(pack_gains(found[0].gains), found[0].feedforward, found[0].estimator)
    (again,) = margin_front(load_boom(*SHORT, corners=True), 1, start=best)
    assert again.figures.tracking == pytest.approx(found[0].figures.tracking, rel=1e-3)
    assert again.converged


def test_its_points_run_on_the_machine_and_stand_in_the_report(found, load_boom, tmp_path):
    study = load_boom(*SHORT, corners=True)
    row = on_the_machine(study, found[0])
    assert 1 < row["performance_index_ms"] < 100
    rows = [row, {**row, "performance_index_ms": None, "disk_margin_guaranteed": None}]
    table = margin_points(rows)
    assert table.rows[0][0] == f"{row['figures']['disk_margin']:.3f}"
    assert [table.rows[1][n] for n in (1, 4)] == ["—", "—"]
    assert table.rows[0][3] == f"{row['by_mass'][0]['performance_index_ms']:.2f}"
    assert row["by_mass"][0]["mass_kg"] == 24_500.0
    keep(tmp_path, "margins", study, rows)
    left = leftovers(tmp_path, study)
    assert left.margins == tuple(rows)
    chapter = margins(Results(study, None, None, study.study.feedforward, leftovers=left))
    assert chapter is not None
    assert isinstance(chapter.blocks[1], Figure)
    drawn = index_over_margin(rows)
    assert np.isnan(drawn.axes[0].lines[1].get_ydata()[1])
    to_svg(drawn)


def test_there_is_no_chapter_without_a_front(boom):
    assert margins(Results(boom, None, None, boom.study.feedforward)) is None
