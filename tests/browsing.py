"""A page served and a browser that looks at it, or the reason why there is none."""

import contextlib
import shutil
import signal
import subprocess
import sys

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
COMPILED = 600_000  # ms, until which kernels that are kept nowhere are compiled, even beside others
LINE = "left-velocity"  # the name of Eq. 17's left side among the page's models


def missing():
    """Return why no browser can be driven here; empty where one can."""
    try:
        import playwright.sync_api  # noqa: F401
    except ImportError:
        return "playwright is not installed"
    return "" if CHROMIUM else "there is no chromium"


@contextlib.contextmanager
def served(study, *options, cwd=None):
    """Serve a study's page; yield the process and its address. Ctrl-C has to end it cleanly."""
    command = [sys.executable, "-m", "mptune.cli", "explore", str(study), "--no-browser", *options]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=cwd
    ) as process:
        try:
            yield process, process.stdout.readline().strip()
        finally:
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
            _, errors = process.communicate(timeout=30)
        assert process.returncode == 0, errors
        assert "Traceback" not in errors, errors


@contextlib.contextmanager
def chromium():
    """Yield a browser."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


def opened(browser, address, **kwargs):
    """Return a tab at an address, once its curves are drawn, and what its console says."""
    page = browser.new_page(viewport={"width": 1280, "height": 900}, **kwargs)
    said, asked = [], []
    page.on("console", lambda message: said.append(message.text) if message.type == "error" else 0)
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("request", lambda request: asked.append(request.url))
    page.goto(address, timeout=COMPILED)
    page.wait_for_function(f"() => {_data('left')}?.length > 50", timeout=COMPILED)
    return page, said, asked


def _data(column):
    model = f"window.Bokeh?.documents[0]?.get_model_by_name('{LINE}')"
    return f"{model}?.data_source.data.{column}"


def curve(page, column):
    """Return what the browser holds of Eq. 17's left side, binding plants or frequencies."""
    return page.evaluate(f"() => Array.from({_data(column)})")


def ratio(page):
    """Return Eq. 17's worst ratio that the browser draws."""
    return max(curve(page, "ratio"))


def until_moved(page, before):
    """Wait until Eq. 17's curve is another than the one whose worst ratio is given."""
    same = f"Math.abs(Math.max(...{_data('ratio')}) - {before!r}) > 1e-6"
    page.wait_for_function(f"() => {same}", timeout=60_000)


def gain(page):
    """Return where the hand has left K_P,vel, once the page has drawn it and rests."""
    shown = page.locator(".noUi-handle").first.get_attribute("aria-valuenow")
    found = 1e3 * float(shown)
    rests = f"() => location.search.includes('gains.k_p_vel={found!r}')"
    page.wait_for_function(rests, timeout=60_000)
    return found


def lamp(page, key):
    """Return a lamp."""
    return page.locator(f'.lamp[data-key="{key}"]')
