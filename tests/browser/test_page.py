"""The page in a real browser: turned by mouse and keys, tuned, saved, reloaded, compared.

A tab costs seconds of work, a server as many: all tests share both, each begins with the published
gains, and the last closes the tab.
"""

import http.client
from pathlib import Path
from urllib.parse import parse_qsl, urlsplit

import numpy as np
import pytest
from browsing import chromium, curve, gain, lamp, missing, opened, ratio, served, until_moved

from mptune.params.gains import read_gains
from mptune.params.load import load_study
from mptune.robust.sweep import sweep

pytestmark = [
    pytest.mark.compiled,
    pytest.mark.skipif(bool(missing()), reason=missing() or "a browser is there"),
]

SMALL = (
    "uncertainty.points=2",
    "verification.repeats=1",
    "verification.seeds=[1]",
    'verification.masses=["24500 kg"]',
    'verification.oil_bulk_moduli=["1200 MPa"]',
    'objective.kind="disturbance"',
)
OPTIONS = [text for one in SMALL for text in ("--set", one)]


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    return tmp_path_factory.mktemp("reports")


@pytest.fixture(scope="module")
def server(study_file, out):
    """The process and its address."""
    options = [*OPTIONS, "--out", str(out), "--end-with-last-tab", "0.5"]
    with served(study_file, *options) as found:
        yield found


@pytest.fixture(scope="module")
def address(server):
    return server[1]


@pytest.fixture(scope="module")
def browser(server):
    with chromium() as found:
        yield found


@pytest.fixture(scope="module")
def tab(browser, address):
    """A tab, what its console says, what it has asked for, and Eq. 17's published worst ratio."""
    page, said, asked_for = opened(browser, address)
    return page, said, asked_for, ratio(page)


@pytest.fixture
def page(tab):
    """The tab at the published gains; its console has nothing to say whatever is done."""
    found, said, _, published = tab
    if ratio(found) != published:
        found.get_by_text("Reset", exact=True).click()
        until_moved(found, ratio(found))
    assert ratio(found) == pytest.approx(published)
    yield found
    assert said == []


def handle(page):
    return page.locator(".noUi-handle").first


def test_turned_by_mouse_and_keys_it_shows_what_sweep_finds(page, tab, address, study_file):
    assert page.get_by_label("K_P,vel", exact=False).and_(handle(page)).count() == 1
    assert page.locator(".noUi-handle:not([aria-label])").count() == 0
    before = ratio(page)
    box = handle(page).bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + 25, box["y"] + 5, steps=5)
    page.mouse.up()
    until_moved(page, before)
    by_mouse, dragged = gain(page), ratio(page)
    assert dragged > before
    handle(page).focus()
    page.keyboard.press("ArrowLeft")
    until_moved(page, dragged)
    assert gain(page) < by_mouse
    assert ratio(page) < dragged
    found = sweep(load_study(study_file, [*SMALL, f"gains.k_p_vel={gain(page)!r} N s/m"]))
    assert ratio(page) == pytest.approx(found.velocity.worst_ratio, rel=2e-4)
    omega = np.array(curve(page, "omega"))
    left = found.model.sides(omega, found.gains).left[0]
    assert curve(page, "left") == pytest.approx(left)
    sure = lamp(page, "velocity_ratio").and_(page.locator('[data-grounds="proved"]'))
    sure.wait_for(timeout=60_000)
    for check in found.checks:
        shown = lamp(page, check.key)
        assert shown.get_attribute("data-status") == check.status.value
        assert check.found_text in shown.inner_text()
    assert lamp(page, "velocity_ratio").get_attribute("data-status") == "violated"
    assert page.locator(".verdict.bad").inner_text().startswith("not met")
    home, asked_for = urlsplit(address).netloc, tab[2]
    assert {urlsplit(url).netloc for url in asked_for if url.startswith("http")} == {home}


def test_undo_a_and_b_reload_and_two_tabs(page, browser, address):
    low = ratio(page)
    page.get_by_text("Keep as A", exact=True).click()
    lamp(page, "velocity_ratio").locator(".kept").wait_for()
    handle(page).focus()
    page.keyboard.press("ArrowRight")
    until_moved(page, low)
    high, turned = ratio(page), 710e3
    page.wait_for_function(f"() => location.search.includes('{turned}')")
    page.get_by_text("Undo", exact=True).click()
    until_moved(page, high)
    assert ratio(page) == pytest.approx(low)
    page.get_by_text("Redo", exact=True).click()
    until_moved(page, low)
    page.get_by_text("Swap A and B", exact=True).click()
    until_moved(page, high)
    assert ratio(page) == pytest.approx(low)
    other, _, _ = opened(browser, address + f"?gains.k_p_vel={turned}")
    assert ratio(other) == pytest.approx(high)
    other.get_by_text("Reset", exact=True).click()
    until_moved(other, high)
    assert ratio(page) == pytest.approx(low)
    other.close()


def test_tuned_and_saved_but_never_over_a_file_unasked(page, out):
    path = out / "boom" / "gains.toml"
    path.parent.mkdir(parents=True)
    path.write_text("mine", encoding="utf-8")
    before = ratio(page)
    page.get_by_text("Tune from here", exact=True).click()
    page.locator("progress").wait_for()
    page.get_by_text("Tuning of boom").wait_for(timeout=120_000)
    until_moved(page, before)
    page.get_by_text("Save and share", exact=True).click()
    page.get_by_text("Save", exact=True).click()
    page.locator(".wrong", has_text="exists").wait_for()
    assert path.read_text(encoding="utf-8") == "mine"
    page.get_by_text("Write over it", exact=True).click()
    page.locator(".note", has_text="written").wait_for(timeout=120_000)
    gains = read_gains(path)
    turned = dict(parse_qsl(urlsplit(page.url).query))
    assert gains.closed_loop == "satisfied"
    assert gains.verdict
    assert gains.gains.k_p_vel == pytest.approx(float(turned["gains.k_p_vel"]))
    page.get_by_text("Save figures", exact=True).click()
    page.locator(".note", has_text="Figures written").wait_for(timeout=120_000)
    drawn = {one.name for one in (out / "boom").glob("explore-*/*.svg")}
    assert {"panels.svg", "bode.svg", "nyquist.svg", "chain.svg"} <= drawn


@pytest.mark.parametrize("headers", [{"Host": "evil.example"}, {"Origin": "http://evil.example"}])
@pytest.mark.parametrize("path", ["", "ws", "static/js/bokeh.min.js"])
def test_other_names_and_origins_are_refused(address, path, headers):
    assert asked(address, path, {}) in {200, 400}  # 400: no handshake
    assert asked(address, path, headers) == 403


def test_without_the_token_there_is_nothing(address):
    home = urlsplit(address)
    for path in ("", "ws", "static/js/bokeh.min.js"):
        assert asked(f"http://{home.netloc}/", path, {}) == 404


@pytest.mark.skipif(not Path("/proc/net/tcp").exists(), reason="only Linux says who listens where")
def test_it_listens_on_the_loopback_interface_only(address):
    port = f":{urlsplit(address).port:04X}"
    tables = [Path(f"/proc/net/{name}").read_text(encoding="utf-8") for name in ("tcp", "tcp6")]
    rows = [row.split() for table in tables for row in table.splitlines()[1:]]
    listening = {row[1] for row in rows if row[1].endswith(port) and row[3] == "0A"}
    assert listening == {f"0100007F{port}"}


def asked(address, path, headers):
    home = urlsplit(address)
    connection = http.client.HTTPConnection(home.netloc, timeout=20)
    connection.request("GET", home.path + path, headers=headers)
    status = connection.getresponse().status
    connection.close()
    return status


def test_it_ends_with_ctrl_c_too(study_file, out):
    """What has made a tab's session and started its work by then; ``served`` looks at the end."""
    with served(study_file, *OPTIONS, "--out", str(out)) as (process, found):
        assert asked(found, "", {}) == 200
        assert process.poll() is None


def test_it_ends_with_the_last_tab(tab, server):
    """The last of this file: others have come and gone."""
    process = server[0]
    assert process.poll() is None
    tab[0].close()
    assert process.wait(timeout=30) == 0
