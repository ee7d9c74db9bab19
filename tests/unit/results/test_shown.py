"""Every public result shows itself in a few lines, at the prompt and in a notebook."""

import html

import numpy as np
import pytest

from mptune.summary import LINES, Summarised

NAMES = (
    "sweep", "unstable", "condition", "family", "sampled", "check", "model", "loops", "plants",
    "margins", "sides", "link", "study", "whole study", "gains file", "tuned", "baseline", "front",
    "front point", "design", "shaped", "structure", "move", "case", "record", "verified",
    "plan", "campaign",
    "panel", "identified", "response", "fit", "weights", "job", "judgement", "change", "difference",
    "papers frame",
)  # fmt: skip
TUPLES = {"plants", "margins", "sides"}


def test_none_is_left_out(results):
    assert set(NAMES) == set(results)


@pytest.mark.parametrize("name", NAMES)
def test_repr_is_short(results, name):
    text = repr(results[name])
    assert 1 <= len(text.splitlines()) <= LINES == 30
    assert len(text) < 3000
    assert "array(" not in text


@pytest.mark.parametrize("name", [name for name in NAMES if name not in TUPLES])
def test_the_headline_is_a_line_of_words(results, name):
    one = results[name]
    assert isinstance(one, Summarised)
    assert len(one.headline.splitlines()) == 1
    assert " " in one.headline


@pytest.mark.parametrize("name", [name for name in NAMES if name not in TUPLES])
def test_a_notebook_shows_the_same_as_a_table(results, name):
    text = results[name]._repr_html_()
    assert text.startswith("<table>")
    assert text.endswith("</table>")
    assert text.count("<tr>") == text.count("</tr>") <= 2 * LINES


def test_what_a_name_holds_is_no_markup_in_a_notebook(results):
    assert "<rig & co>" in repr(results["response"])
    text = results["response"]._repr_html_()
    assert "<rig & co>" in html.unescape(text)
    assert "<rig" not in text


def test_verdict_and_worst_places_are_there(results):
    text = repr(results["sweep"])
    assert "every requirement met" in text
    for part in ("0.641", "0.476", "24.5 t", "d 21.5 ms", "velocity_ratio (Eq. 17)"):
        assert part in text
    assert "not every requirement met" in repr(results["unstable"])


def test_arrays_are_shown_by_shape_and_range(results):
    text = repr(results["plants"])
    count = results["plants"].number
    assert f"mass     ({count},) float64, 24500 … 49000" in text
    many = repr(results["front"]).splitlines()
    assert many[-2].strip() == "… and 34 more"


def test_what_is_not_finite_is_counted():
    class Held(Summarised):
        _fields = ("values", "none", "empty")
        values = np.array([1.0, np.nan, np.inf])
        none = np.array([np.nan])
        empty = ()

    text = repr(Held())
    assert "1 … 1, 2 not finite" in text
    assert "none finite" in text
    assert text.splitlines()[-1].split() == ["empty", "none"]
