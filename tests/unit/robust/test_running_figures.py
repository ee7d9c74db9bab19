"""Figures of the loop as it runs for a search, beside those of the verdict and of a dense grid."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.loops.broken import FORCE
from mptune.loops.running import running_family, sampled_at
from mptune.loops.sampled import sampled_loop, stable_as_sampled
from mptune.robust.grid import first_grid
from mptune.robust.margins import sampled_margins
from mptune.robust.model import LinearModel
from mptune.robust.running import family_figures, running_figures

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

LOW = 0.05


@pytest.fixture(scope="module")
def model(load_boom):
    return LinearModel.of(load_boom(uncertainty="section-5-1", corners=True))


@pytest.fixture(scope="module")
def family(model):
    return running_family(LOW, model.as_it_runs(model.gains).plants, model.filters, model.period)


def scattered(model, count):
    rng = np.random.default_rng(3)
    for factors in np.exp(rng.uniform(-0.7, 0.7, (count, 6))):
        yield model.gains._make(np.array(model.gains) * factors)


def test_figures_are_those_of_the_verdict(model, family):
    unstable = 0
    for gains in scattered(model, 30):
        loops = model.as_it_runs(gains)
        found = running_figures(family, gains)
        exact = sampled_margins(first_grid(LOW, 400.0), loops, model.period)
        stable = stable_as_sampled(loops, model.period)[0]
        unstable += int(np.sum(~stable))
        np.testing.assert_array_equal(found.stable, stable)
        sign = np.where(stable, 1, -1)
        # Where a loop is all but unstable the verdict's golden section is the coarser one.
        sharp = {"rtol": 1e-4, "atol": 1e-6}
        np.testing.assert_allclose(found.disk_margin, sign * exact.disk_margin[FORCE], **sharp)
        np.testing.assert_allclose(found.phase_margin, sign * exact.phase_margin[FORCE], rtol=1e-6)
        factor = np.where(stable, exact.gain_margin[FORCE], exact.gain_reduction[FORCE])
        np.testing.assert_allclose(found.gain_margin, factor, rtol=1e-8)
        tame = exact.sensitivity_peak[FORCE] < 100
        peaks = found.sensitivity_peak[tame], exact.sensitivity_peak[FORCE][tame]
        np.testing.assert_allclose(*peaks, rtol=1e-5)
        peaks = found.peak_compliance[tame], exact.peak_compliance[FORCE][tame]
        np.testing.assert_allclose(*peaks, rtol=1e-5)
    assert unstable > 10


def test_the_compliance_is_that_of_a_dense_grid(model, family):
    dense = np.linspace(1.0, 100.0, 20000)
    found = running_figures(family, model.gains)
    for n in (0, 7, 15):
        plant = sampled_at(family, n)
        loop = np.array([sampled_loop(1j * w, plant, model.gains, model.period) for w in dense])
        size = 1 / np.abs(1 + loop) / (family.mass[n] * dense**2)
        assert found.peak_compliance[n] == pytest.approx(size.max(), rel=1e-6)
        assert found.compliance_frequency[n] == pytest.approx(dense[np.argmax(size)], rel=1e-3)


def test_with_that_much_more_delay_a_loop_is_all_but_unstable(model, family):
    margin = running_figures(family, model.gains).delay_margin
    plants = model.as_it_runs(model.gains).plants
    for share, stable in ((0.99, True), (1.01, False)):
        later = plants._replace(delay=plants.delay + share * margin)
        loops = model.as_it_runs(model.gains, later)
        assert (stable_as_sampled(loops, model.period)[0] == stable).all()


def test_signed_margins_pass_smoothly_through_zero(model, family):
    """Across the boundary of stability every step of the gain moves them by about as much."""
    factors = np.linspace(1.15, 1.35, 41)
    for name in ("disk_margin", "phase_margin", "delay_margin"):
        values = [
            getattr(running_figures(family, model.gains._replace(k_p_vel=k * 700e3)), name).min()
            for k in factors
        ]
        steps = np.diff(values)
        assert values[0] > 0 > values[-1]
        assert (steps < 0).all()
        assert steps.min() > 1.6 * steps.max()


def test_a_family_in_blocks_is_the_family(model, family, monkeypatch):
    whole = running_figures(family, model.gains)
    monkeypatch.setattr("mptune.robust.running._BLOCK", 5)
    parts = family_figures(model.as_it_runs(model.gains), model.period, LOW)
    for one, other in zip(whole, parts, strict=True):
        np.testing.assert_array_equal(one, other)
