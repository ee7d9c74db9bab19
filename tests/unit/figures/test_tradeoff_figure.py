"""What tuning trades, drawn: every controller named, every point on the axes, nothing covered."""

import re

import numpy as np
import pytest

from mptune.figures.style import to_png, to_svg
from mptune.figures.tradeoff import compared_controllers, pareto_front
from mptune.tune.baselines import LABELS, Baseline
from mptune.tune.front import Front, FrontPoint
from mptune.tune.objective import Figures


def figures(tracking, integral=22.0):
    return Figures(tracking, integral, 1.3e-7, 16.0)


@pytest.fixture
def rows(fig_5):
    gains = fig_5.gains
    index = {"own": 0.0144, "p": 0.0177, "pi": 0.0172, "pid": 0.0158, "eq22": 0.0109}
    return tuple(Baseline(name, None, gains, figures(one), fig_5) for name, one in index.items())


def test_every_controller_has_its_curve_its_bar_and_its_value(rows):
    drawn = compared_controllers(rows)
    sides, bars = drawn.axes
    assert [label.get_text() for label in bars.get_yticklabels()] == list(LABELS.values())
    assert [text.get_text() for text in bars.texts] == ["14.4", "17.7", "17.2", "15.8", "10.9"]
    widths = [bar.get_width() for bar in bars.patches]
    assert widths == pytest.approx([14.4, 17.7, 17.2, 15.8, 10.9])
    assert len(sides.lines) == 6
    for axes in drawn.axes:
        assert re.search(r"\[.+\]", axes.get_xlabel())
    assert max(widths) < bars.get_xlim()[1]


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_an_index_without_a_number_is_drawn_too(rows, bad):
    runaway = Baseline("own", None, rows[0].gains, figures(bad), rows[0].sweep)
    drawn = compared_controllers((runaway, *rows[1:]))
    assert drawn.axes[1].texts[0].get_text() == "–"
    assert to_png(drawn).startswith(b"\x89PNG")


def test_the_front_has_every_point_and_the_studys_own(fig_5):
    points = tuple(
        FrontPoint(fig_5.gains, figures(0.011 + 1e-4 * n, 50.0 + 5 * n), converged=True)
        for n in range(5)
    )
    (axes,) = pareto_front(Front(points, figures(0.0144))).axes
    curve, own = axes.lines
    np.testing.assert_allclose(curve.get_xdata(), [50, 55, 60, 65, 70])
    np.testing.assert_allclose(curve.get_ydata(), [11, 11.1, 11.2, 11.3, 11.4])
    assert (list(own.get_xdata()), list(own.get_ydata())) == ([22.0], [pytest.approx(14.4)])
    low, high = axes.get_xlim()
    assert low < 22
    assert high > 70
    assert axes.get_legend() is None  # it stands below, over no data


def test_an_empty_front_is_drawn_as_what_there_is():
    drawn = pareto_front(Front((), figures(0.0144)))
    assert to_png(drawn).startswith(b"\x89PNG")


def test_the_figures_are_files_of_their_kind(rows):
    assert to_svg(compared_controllers(rows)).lstrip().startswith(b"<?xml")
