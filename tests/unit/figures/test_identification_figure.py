"""Fig. 3's drawing: nothing valid left out, nothing invalid drawn, labels with units."""

import re

import numpy as np
import pytest

from mptune.figures.identification import bode_panels
from mptune.figures.style import to_png, to_svg
from mptune.identify.result import Panel


def panel_of(position, *, bad=0):
    """Return three points that lag by their own time, the first ``bad`` without a fit."""
    omega = np.geomspace(1, 200, 8)
    lag = np.array([8e-3, 9e-3, 10e-3])[:, None]
    response = np.exp(-1j * omega * lag)
    status = np.zeros((3, 8), np.int64)
    response[:bad], status[:bad] = np.nan, 1
    return Panel(
        position_m=position, oil_bulk_modulus_pa=8e8, valve_delay_s=0.0, tau_a_s=0.0, tau_b_s=0.0,
        omega=omega, velocity=np.zeros(3), pressure_a=np.zeros(3), skipped=2, response=response,
        quality=np.ones((3, 8)), status=status, theory=np.exp(-9e-3j * omega),
    )  # fmt: skip


@pytest.fixture
def panels():
    return tuple(panel_of(0.1 * k, bad=k) for k in range(4))


def test_each_panel_has_magnitude_and_phase_with_units(panels):
    axes = bode_panels(panels).axes
    assert len(axes) == 8
    assert sum("[dB]" in one.get_ylabel() for one in axes) == 4
    assert sum("[°]" in one.get_ylabel() for one in axes) == 4
    for one in axes:
        if "[°]" in one.get_ylabel():
            assert re.search(r"\[rad/s\]", one.get_xlabel())


def test_failed_fits_are_absent_and_counted(panels):
    axes = bode_panels(panels).axes
    magnitudes = [one for one in axes if "[dB]" in one.get_ylabel()]
    for bad, one in enumerate(magnitudes):
        drawn = [line for line in one.lines[:-2] if np.isfinite(line.get_ydata()).any()]
        (text,) = one.texts
        assert f"3 points, 2 skipped; {8 * bad} of 24 fits not valid" in text.get_text()
        assert len(drawn) == min(3 - bad, 1)  # equal magnitudes are drawn once


def test_phases_are_unwrapped_along_theory(panels):
    phase = bode_panels(panels[:1]).axes[1]
    lowest = min(np.nanmin(line.get_ydata()) for line in phase.lines)
    assert lowest == pytest.approx(np.degrees(-200 * 10e-3), abs=0.1)
    assert phase.get_ylim()[0] < lowest


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_any_number_of_panels_is_drawn(panels, count):
    figure = bode_panels(panels[:count])
    assert len(figure.axes) == 2 * count
    assert to_png(figure, 50).startswith(b"\x89PNG")


def test_the_same_result_gives_the_same_bytes(panels):
    assert to_svg(bode_panels(panels)) == to_svg(bode_panels(panels))


def test_titles_and_legend_fit(panels):
    figure = bode_panels(panels)
    figure.draw_without_rendering()
    (legend,) = figure.legends
    box = legend.get_window_extent()
    for one in figure.axes:
        assert not box.overlaps(one.get_window_extent())
        assert one.title.get_window_extent().x1 <= figure.bbox.x1
