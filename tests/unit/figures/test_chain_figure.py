"""The chain drawn: every value written, nothing covered, bars on the side of 1 they belong to."""

import re

import numpy as np
import pytest

from mptune.figures.chain import gain_chain
from mptune.figures.style import to_png, to_svg
from mptune.robust.chain import Link, factor_text

CHAINS = {
    "published": (1.99, 2.06, 1.232, 1.24, 1.5),
    "unstable": (1.56, 1.2, 0.85, 0.9, 0.03),
    "odd": (np.inf, np.nan, 1.0, 30.0),
    "one": (1.4,),
}
NAMES = ("Eq. 17 and 21", "true family", "with measurement path", "sampled", "nonlinear machine")


def links_of(case):
    return tuple(Link(NAMES[i], factor, None) for i, factor in enumerate(CHAINS[case]))


@pytest.mark.parametrize("case", CHAINS)
def test_every_link_has_its_name_its_value_and_its_bar(case):
    links = links_of(case)
    (axes,) = gain_chain(links).axes
    assert [label.get_text() for label in axes.get_yticklabels()] == [link.name for link in links]
    assert [text.get_text() for text in axes.texts] == [factor_text(one.factor) for one in links]
    assert re.search(r"\[.+\]", axes.get_xlabel())
    for link, bar in zip(links, axes.patches, strict=True):
        ends = sorted((bar.get_x(), bar.get_x() + bar.get_width()))
        if np.isfinite(link.factor):
            assert ends == pytest.approx(sorted((1.0, link.factor)))
        low, high = axes.get_xlim()
        assert low <= ends[0] <= ends[1] <= high * (1 + 1e-12)


@pytest.mark.parametrize("case", CHAINS)
def test_values_stay_within_the_axes(case):
    figure = gain_chain(links_of(case))
    figure.draw_without_rendering()
    (axes,) = figure.axes
    frame = axes.get_window_extent()
    for text in axes.texts:
        box = text.get_window_extent()
        assert frame.x0 <= box.x0
        assert box.x1 <= frame.x1


def test_the_first_link_is_on_top_and_a_lack_differs_in_grey():
    (axes,) = gain_chain(links_of("unstable")).axes
    bottom, top = axes.get_ylim()
    assert bottom > top
    hatches = [bool(bar.get_hatch()) for bar in axes.patches]
    assert hatches == [False, False, True, True, True]


def test_the_same_chain_gives_the_same_bytes():
    links = links_of("published")
    assert to_svg(gain_chain(links)) == to_svg(gain_chain(links))
    assert to_png(gain_chain(links), 50).startswith(b"\x89PNG")
