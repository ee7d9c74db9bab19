"""How long Fig. 3 takes, and how well it agrees with Eq. 11; run with ``make trials``."""

import time

import pytest

from mptune.identify.excitation import Excitation
from mptune.identify.identify import identify
from mptune.identify.result import BANDS

pytestmark = [pytest.mark.bench, pytest.mark.trial]


@pytest.mark.parametrize("excitation", list(Excitation))
def test_four_panels_take_less_than_a_minute(boom, load_boom, excitation):
    identify(load_boom('identification.pressures=["5 MPa"]', "identification.frequencies=2"))
    start, before = time.perf_counter(), time.process_time()
    result = identify(boom, excitation)
    elapsed, used = time.perf_counter() - start, time.process_time() - before
    print(f"\n{excitation}: four panels in {elapsed:.1f} s, {used:.1f} s of processor time")
    for panel in result.panels:
        print(
            f"{panel.name}: {panel.skipped} skipped, {panel.failed} of {panel.status.size} failed"
        )
        for band in BANDS:
            one = panel.agreement(band)
            print(
                f"  {band.low:g}-{band.high:g} rad/s: median at most {one.median_decibels:.2f} dB, "
                f"{one.median_degrees:.1f}°; any {one.largest_decibels:.2f} dB, "
                f"{one.largest_degrees:.1f}°; {100 * one.within:.1f} % within the limits"
            )
    assert elapsed < 60
    assert result.satisfied or excitation is not Excitation.SINE
