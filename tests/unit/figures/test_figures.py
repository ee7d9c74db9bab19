"""Figures: labelled axes with units, the same bytes for the same result, nothing covered."""

import re

import pytest

from mptune.figures.bode import bode_plots
from mptune.figures.compare import compared_gains
from mptune.figures.moves import move_traces
from mptune.figures.nyquist import nyquist_plots
from mptune.figures.panels import four_panels
from mptune.figures.sensitivity import load_response, sensitivity_functions
from mptune.figures.style import to_png, to_svg
from mptune.robust.chain import chain
from mptune.robust.encirclements import encirclements
from mptune.robust.sweep import sweep
from mptune.sim.sampled import linear_moves

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes


@pytest.fixture(scope="module")
def swept(load_boom):
    return sweep(load_boom(corners=True))


@pytest.fixture(scope="module")
def estimated(load_boom):
    return sweep(load_boom('estimator.kind="state"', corners=True, uncertainty="section-5-1"))


@pytest.fixture(
    scope="module", params=["panels", "bode", "moves", "nyquist", "sensitivity", "load", "compare"]
)
def draw(request, swept):
    moves, counts = linear_moves(swept.study), encirclements(swept)
    return {
        "panels": lambda: four_panels(swept),
        "bode": lambda: bode_plots(swept),
        "moves": lambda: move_traces(moves),
        "nyquist": lambda: nyquist_plots(swept, counts),
        "sensitivity": lambda: sensitivity_functions(swept),
        "load": lambda: load_response(swept),
        "compare": lambda: compared_gains([("a", swept, moves), ("b", swept, moves)]),
    }[request.param]


def test_axes_carry_units(draw):
    axes = draw().axes
    for one in axes:
        shared = one.get_shared_y_axes().get_siblings(one)
        assert any(re.search(r"\[.+\]", other.get_ylabel()) for other in shared)
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


def test_titles_and_labels_stay_within_the_figure_and_titles_off_one_another(draw):
    figure = draw()
    figure.draw_without_rendering()
    titles = [one._left_title for one in figure.axes if one.get_title(loc="left")]
    labels = [axis.label for one in figure.axes for axis in (one.xaxis, one.yaxis)]
    boxes = [title.get_window_extent() for title in titles]
    for box in boxes + [label.get_window_extent() for label in labels if label.get_text()]:
        assert figure.bbox.x0 <= box.x0
        assert box.x1 <= figure.bbox.x1
        assert figure.bbox.y0 <= box.y0
        assert box.y1 <= figure.bbox.y1
    for n, box in enumerate(boxes):
        assert not any(box.overlaps(other) for other in boxes[:n])


@pytest.mark.parametrize("drawn", ["panels", "bode", "nyquist", "sensitivity", "load"])
def test_with_a_state_estimator_each_figure_is_of_the_loop_with_it(estimated, drawn):
    figure = estimated.plot(drawn)
    (legend,) = figure.legends
    words = [text.get_text() for text in legend.get_texts()]
    assert not any("measurement path" in word for word in words)
    if drawn in {"bode", "nyquist", "sensitivity"}:
        assert any("with state estimator" in word for word in words)


def test_around_a_state_estimator_no_verdict_rests_on_what_leaves_it_out(estimated):
    beside = {link.name: link.beside for link in chain(estimated)}
    assert beside == {
        "Eq. 17 and 21": True, "true family": True, "with state estimator": False, "sampled": False,
    }  # fmt: skip
