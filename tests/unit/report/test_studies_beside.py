"""Studies beside the paper: the table, its Markdown, the chapter, the figure, and what is kept."""

import pytest

from mptune.figures.studies import studies_apart
from mptune.figures.style import to_svg
from mptune.job.kept_rows import checked_rows
from mptune.job.leftovers import keep, leftovers
from mptune.params.paper import MEASURED_LOSS
from mptune.report.blocks import Cell, Figure, plain
from mptune.report.content.studies import compared_studies, markdown, studies
from mptune.report.results import Leftovers, Results

ROW = {
    "study": "boom-estimator", "gains": "tuned", "mass_kg": 24500.0, "stable": True,
    "performance_index_ms": 2.7, "energy_loss_j_per_mm": 14.2, "force_error_integral_kn2s": 17.5,
    "valve_switches": 524.0, "final_error_mm": 0.35, "gain_margin": 1.512, "disk_margin": 0.2412,
    "disk_margin_guaranteed": 0.24, "noise_force_n": 699.6,
}  # fmt: skip
MACHINE = [key for key in ROW if key.endswith(("_ms", "_mm", "_kn2s", "_switches"))]


def unstable():
    return {**ROW, **dict.fromkeys(MACHINE), "stable": False, "mass_kg": 49000.0}


def test_the_paper_stands_first_and_every_row_follows():
    table = compared_studies([ROW, unstable()])
    paper, rows = table.rows[: len(MEASURED_LOSS)], table.rows[len(MEASURED_LOSS) :]
    assert [row[2] for row in paper] == ["24.5", "49"]
    assert [row[4] for row in paper] == ["19.5", "18.9"]
    assert [row[3] for row in paper] == ["13.1–30.4", "18.1–33.7"]
    assert [row[5] for row in paper] == ["—", "50.8"]  # §7.3 tells of the larger mass alone
    assert rows[0] == [
        "boom-estimator", "tuned", "24.5", "2.7", "14.2", "17.5", "524", "0.35", "1.51", "0.24",
        "0.24", "700",
    ]  # fmt: skip
    assert rows[1][3] == Cell("not stable", "bad")
    assert all(len(row) == len(table.columns) for row in table.rows)


def test_a_study_that_was_not_run_on_the_machine_has_its_margins_alone():
    row = {**ROW, **dict.fromkeys(MACHINE), "stable": None, "mass_kg": None}
    last = compared_studies([row]).rows[-1]
    assert last[2:8] == ["—"] * 6
    assert last[8] == "1.51"
    to_svg(studies_apart([row]))


def test_markdown_has_a_line_per_row_and_no_break_within():
    table = compared_studies([ROW, unstable()])
    title, _, *lines, _, legend = markdown(table).strip().split("\n")
    assert title == "## Studies beside the paper"
    assert len(lines) == 2 + len(table.rows)
    assert {line.count("|") for line in lines} == {len(table.columns) + 1}
    assert "Performance" not in lines[0]
    assert "guaranteed" in lines[0]
    assert legend == table.legend


def test_the_figure_has_a_panel_per_mass_and_says_what_is_calibrated():
    panels = studies_apart([ROW, {**ROW, "mass_kg": 36000.0}]).axes
    assert [axes.get_title() for axes in panels] == ["24.5 t", "36 t", "49 t"]
    assert "calibrated" in panels[0].get_ylabel()
    assert all("predicted" in axes.get_xlabel() for axes in panels)
    marked = [line for line in panels[0].lines if line.get_marker() == "o"]
    assert [tuple(line.get_xydata()[0]) for line in marked] == [(2.7, 14.2)]
    assert marked[0].get_markerfacecolor() == marked[0].get_color()
    assert all(axes.get_xlim()[1] > 33.7 and axes.get_ylim()[1] > 19.5 for axes in panels)
    own = studies_apart([{**ROW, "gains": "own"}]).axes[0]
    assert [line.get_markerfacecolor() for line in own.lines if line.get_marker() == "o"] == [
        "white"
    ]


def test_the_report_shows_what_is_kept_and_nothing_else(boom, tmp_path):
    keep(tmp_path, "studies", boom, [ROW])
    left = leftovers(tmp_path, boom)
    assert left.studies == (ROW,)
    chapter = studies(Results(boom, None, None, boom.study.feedforward, leftovers=left))
    assert chapter is not None
    assert isinstance(chapter.blocks[0], Figure)
    assert plain(chapter.blocks[1])["rows"][-1][0] == "boom-estimator"
    nothing = Results(boom, None, None, boom.study.feedforward, leftovers=Leftovers())
    assert studies(nothing) is None


@pytest.mark.parametrize("change", [{"gains": "mine"}, {"gain_margin": "much"}, {"stable": 1.5}])
def test_rows_of_another_shape_are_refused(change):
    with pytest.raises(ValueError, match=r"rows\.0"):
        checked_rows("studies", [{**ROW, **change}])
