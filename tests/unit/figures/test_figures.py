"""Figures: labelled axes with units, the same bytes for the same result, nothing covered."""

import re

import pytest

from mptune.figures.bode import bode_plots
from mptune.figures.moves import move_traces
from mptune.figures.panels import four_panels
from mptune.figures.style import to_png, to_svg
from mptune.robust.sweep import sweep
from mptune.sim.sampled import linear_moves

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes


@pytest.fixture(scope="module")
def swept(load_boom):
    return sweep(load_boom(corners=True))


@pytest.fixture(scope="module", params=["panels", "bode", "moves"])
def draw(request, swept):
    moves = linear_moves(swept.study)
    return {
        "panels": lambda: four_panels(swept),
        "bode": lambda: bode_plots(swept),
        "moves": lambda: move_traces(moves),
    }[request.param]


def test_axes_carry_units(draw):
    axes = draw().axes
    for one in axes:
        assert re.search(r"\[.+\]", one.get_ylabel())
    lowest = [one for one in axes if one.get_subplotspec().is_last_row()]
    for one in lowest:
        assert re.search(r"\[.+\]", one.get_xlabel())


def test_legend_covers_no_axes(draw):
    figure = draw()
    figure.draw_without_rendering()
    (legend,) = figure.legends
    box = legend.get_window_extent()
    for one in figure.axes:
        assert legend.axes is None
        assert not one.get_legend()
        assert not box.overlaps(one.get_window_extent())
    assert figure.bbox.x0 <= box.x0
    assert box.x1 <= figure.bbox.x1


def test_the_same_result_gives_the_same_bytes(draw):
    assert to_svg(draw()) == to_svg(draw())


def test_png_is_a_picture(draw):
    assert to_png(draw(), 50).startswith(b"\x89PNG")
