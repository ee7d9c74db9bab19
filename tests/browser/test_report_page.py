"""The report on a small screen and in the dark: nothing cut, no unit broken, figures open large."""

import re

import pytest
from browsing import chromium, missing

from mptune.figures.style import new_figure, to_svg
from mptune.report import web
from mptune.report.blocks import (
    Cell,
    Chapter,
    Document,
    Equations,
    Figure,
    FrontPage,
    Prose,
    Tabular,
    left,
)

pytestmark = [
    pytest.mark.compiled,
    pytest.mark.skipif(bool(missing()), reason=missing() or "a browser is there"),
]

PLACE = "24.5 t, d 21.5 ms, τ 12.2/11.9 ms, ω 55.2 rad/s"
WIDTH = 390


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    figure = new_figure(3)
    figure.subplots().plot([0, 1], [0, 1])
    names = re.findall(r"^  (\w+): \(", web.resources.files("mptune.report").joinpath(
        "equations.typ").read_text(encoding="utf-8"), re.MULTILINE)  # fmt: skip
    rows = [["K", "709.2 kN s/m", Cell("709.2 kN s/m", "strong"), Cell(PLACE, "small")]]
    table = Tabular("t", left(*"abcd"), rows, keep=False)
    blocks = [Prose(f"The gain is 709.2 kN s/m at {PLACE}."), Equations([names]), table]
    chapter = Chapter.of("Loops", *blocks, Figure("A figure.", "drawn"))
    front = FrontPage(["about"], "met", ["status"], [], [table])
    document = Document("title", "title", satisfied=True, front=front, chapters=[chapter])
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(web.web_page(document, {"drawn": to_svg(figure)}), encoding="utf-8")
    return path.as_uri()


@pytest.fixture(scope="module")
def browser():
    with chromium() as found:
        yield found


@pytest.fixture
def page(browser, report):
    found = browser.new_page(
        viewport={"width": WIDTH, "height": 844}, color_scheme="dark", java_script_enabled=True
    )
    found.goto(report)
    yield found
    found.close()


def test_nothing_is_cut_on_a_small_screen(page):
    assert page.evaluate("document.documentElement.scrollWidth") <= WIDTH
    edges = page.evaluate(
        "[...document.querySelectorAll('.equation svg')]"
        ".map(one => one.getBoundingClientRect().right)"
    )
    assert len(edges) > 10
    assert max(edges) <= WIDTH


def test_no_unit_is_torn_from_its_number(page):
    text = page.locator("section").inner_text().replace("\n", " ")
    for quantity in ("709.2 kN s/m", "24.5 t", "21.5 ms", "12.2/11.9 ms", "55.2 rad/s"):
        assert quantity not in text
        assert quantity.replace(" ", "\N{NO-BREAK SPACE}") in text


def test_the_dark_is_dark_and_figures_open_large(page):
    ground = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert max(map(int, re.findall(r"\d+", ground)[:3])) < 60
    small = page.locator("figure svg").bounding_box()["width"]
    page.locator("figure a").first.click()
    assert page.locator("figure svg").bounding_box()["width"] > 1.8 * small
    page.get_by_text("back to the page").click()
    assert page.locator("figure svg").bounding_box()["width"] == small
