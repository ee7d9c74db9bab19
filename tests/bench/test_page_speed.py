"""How fast the page follows a hand with the whole family, and what long turning leaves behind."""

import os
import random
import time
from pathlib import Path

import numpy as np
import pytest
from browsing import chromium, missing, opened, served

from mptune.explore.move import simulated_move

pytestmark = [
    pytest.mark.bench,
    pytest.mark.skipif(bool(missing()), reason=missing() or "a browser is there"),
]

EVENTS = 60
SECONDS = 300
_PAGE = os.sysconf("SC_PAGE_SIZE")
_TURN = """
async ([handle, count]) => {
  const source = Bokeh.documents[0].get_model_by_name('left-velocity').data_source;
  const frame = () => new Promise(requestAnimationFrame), times = [];
  for (let n = 0; n < count; n++) {
    const before = source.data.ratio, begun = performance.now();
    const key = n % 2 ? 'ArrowLeft' : 'ArrowRight';
    handle.dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true}));
    while (source.data.ratio === before && performance.now() - begun < 5000) await frame();
    await frame();
    times.push(performance.now() - begun);
    await new Promise(resolve => setTimeout(resolve, 60));
  }
  return times;
}
"""


@pytest.fixture
def page(study_file):
    with served(study_file) as (process, address), chromium() as browser:
        found, said, _ = opened(browser, address)
        time.sleep(5)  # the first move and its kernels
        yield process, found
        assert said == []


def test_from_event_to_drawn_curve(page):
    _, tab = page
    handle = tab.locator(".noUi-handle").first.element_handle()
    tab.evaluate(_TURN, [handle, 5])
    times = np.array(tab.evaluate(_TURN, [handle, EVENTS]))
    middle, most = np.median(times), np.quantile(times, 0.95)
    print(f"\nevent to drawn curve, 7⁴ plants: median {middle:.0f} ms, 95 % {most:.0f} ms")
    assert middle <= 80
    assert most <= 150


def test_a_simulated_move(boom):
    simulated_move(boom, 24500.0)
    times = []
    for _ in range(10):
        begun = time.perf_counter()
        simulated_move(boom, 24500.0)
        times.append(1e3 * (time.perf_counter() - begun))
    print(f"\na move of 2.25 s: median {np.median(times):.0f} ms, longest {max(times):.0f} ms")
    assert np.median(times) <= 150


@pytest.mark.trial
def test_long_turning_leaves_nothing_behind(page):
    """Five minutes of random turning, some hundreds of rests among them."""
    process, tab = page
    handles = [one for one in tab.locator(".noUi-handle").all() if one.is_visible()]
    draw = random.Random(1)  # noqa: S311 - no secret
    sizes, events = [], 0
    end = time.monotonic() + SECONDS
    while time.monotonic() < end:
        draw.choice(handles).focus()
        for _ in range(draw.randint(5, 20)):
            tab.keyboard.press(draw.choice(["ArrowLeft", "ArrowRight", "PageUp", "PageDown"]))
            time.sleep(0.03)
            events += 1
        time.sleep(draw.choice([0.0, 0.4]))
        sizes.append(resident(process.pid))
    tab.get_by_text("Stop", exact=True).click()
    third = len(sizes) // 3
    early, late = np.median(sizes[third : 2 * third]), np.median(sizes[-third:])
    kept = children(process.pid)
    print(f"\n{events} events: {early / 1e6:.0f} MB, then {late / 1e6:.0f} MB, {kept} processes")
    assert late <= 1.05 * early
    assert kept <= 2  # the worker's, and multiprocessing's own that tracks resources


def resident(number):
    return _PAGE * int(Path(f"/proc/{number}/statm").read_text(encoding="utf-8").split()[1])


def children(number):
    text = Path(f"/proc/{number}/task/{number}/children").read_text(encoding="utf-8")
    return len(text.split())
