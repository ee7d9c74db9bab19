"""Margins are where the verdict flips: two routes, frequency response and encirclement count."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mptune.loops.broken import FORCE, POSITION, VELOCITY
from mptune.loops.family import FamilyLoops
from mptune.loops.stability import count_unstable_poles
from mptune.params.packed import NO_PATH, LoopGains, MeasurementPath, NominalPlant, Plants
from mptune.robust.grid import first_grid, frequency_range
from mptune.robust.margins import family_margins

SHARE_A = 4 / 7
FILTERS = MeasurementPath(0.0005, float(np.exp(-0.0005 / 0.012)), 0.012)
NEAR = 1e-4

plants = st.builds(
    lambda *values: Plants(*(np.array([value]) for value in values)),
    st.floats(10e3, 60e3),
    st.floats(0.001, 0.03),
    st.floats(0.0, 0.015),
    st.floats(0.0, 0.015),
    st.just(SHARE_A),
)
gains = st.builds(
    LoopGains,
    st.floats(50e3, 1500e3),
    st.floats(0.5, 40.0),
    st.just(0.0) | st.floats(0.5, 200.0),
    st.floats(10.0, 200.0),
    st.floats(0.2, 2.0),
    st.floats(0.002, 0.03),
)
paths = st.sampled_from([NO_PATH, FILTERS])


def stable(plant, gain, path, which=FORCE):
    count = count_unstable_poles(FamilyLoops(plant, gain, path, which))
    assert count.decided.all()
    return bool(count.stable[0])


def margins_of(plant, gain, path):
    nominal = NominalPlant(float(plant.mass[0]), float(plant.delay[0]))
    omega = first_grid(*frequency_range(plant, nominal, gain))
    return family_margins(omega, FamilyLoops(plant, gain, path))


def scaled(gain, which, factor):
    """Return the gains that multiply the loop gain at ``which`` by the factor."""
    if which == POSITION:
        return gain._replace(k_p_pos=gain.k_p_pos * factor, k_i_pos=gain.k_i_pos * factor)
    return gain._replace(k_p_vel=gain.k_p_vel * factor)


@pytest.mark.parametrize("which", [VELOCITY, POSITION, FORCE])
@given(plants, gains, paths)
def test_the_gain_margin_is_where_stability_ends(which, plant, gain, path):
    verdict = VELOCITY if which == VELOCITY else FORCE
    assume(stable(plant, gain, path) and stable(plant, gain, path, VELOCITY))
    margin = float(margins_of(plant, gain, path).gain_margin[which, 0])
    assume(1 + 3 * NEAR < margin < 1e4)
    assert stable(plant, scaled(gain, which, margin * (1 - NEAR)), path, verdict)
    assert not stable(plant, scaled(gain, which, margin * (1 + NEAR)), path, verdict)


@given(plants, gains, paths)
def test_the_gain_reduction_is_where_stability_ends_downwards(plant, gain, path):
    gain = gain._replace(k_i_pos=gain.k_i_pos + 1.0)
    assume(stable(plant, gain, path))
    reduction = float(margins_of(plant, gain, path).gain_reduction[FORCE, 0])
    assume(1e-3 < reduction < 1 - 3 * NEAR)
    assert stable(plant, scaled(gain, FORCE, reduction * (1 + NEAR)), path)
    assert not stable(plant, scaled(gain, FORCE, reduction * (1 - NEAR)), path)


@pytest.mark.parametrize("which", [VELOCITY, FORCE])
@given(plants, gains, paths)
def test_the_delay_margin_is_where_stability_ends(which, plant, gain, path):
    assume(stable(plant, gain, path, which))
    margin = float(margins_of(plant, gain, path).delay_margin[which, 0])
    assume(1e-4 < margin < 10)
    assert stable(plant._replace(delay=plant.delay + margin * (1 - NEAR)), gain, path, which)
    assert not stable(plant._replace(delay=plant.delay + margin * (1 + NEAR)), gain, path, which)


@pytest.mark.parametrize("which", [VELOCITY, POSITION, FORCE])
@given(plants, gains, paths)
def test_a_disk_margin_bounds_gain_and_phase_margin(which, plant, gain, path):
    assume(stable(plant, gain, path, VELOCITY if which == VELOCITY else FORCE))
    margins = margins_of(plant, gain, path)
    disk = margins.disk_margin[which, 0]
    assert 0 <= disk <= 2 * (1 + 1e-3)
    disk = min(disk, 2 - 1e-9)
    tolerance = 1 + 1e-6
    assert margins.gain_margin[which, 0] * tolerance >= (2 + disk) / (2 - disk)
    assert margins.gain_reduction[which, 0] <= (2 - disk) / (2 + disk) * tolerance
    assert margins.phase_margin[which, 0] * tolerance >= 2 * np.arctan(disk / 2)


@pytest.mark.parametrize("which", [VELOCITY, POSITION, FORCE])
@given(plants, gains, paths)
def test_a_sensitivity_peak_bounds_gain_and_phase_margin(which, plant, gain, path):
    assume(stable(plant, gain, path, VELOCITY if which == VELOCITY else FORCE))
    margins = margins_of(plant, gain, path)
    peak = margins.sensitivity_peak[which, 0]
    tolerance = 1 + 1e-6
    assert peak >= 1 - 1e-3  # |S| → 1 at high frequency
    assert margins.gain_margin[which, 0] * tolerance >= peak / (peak - 1) or peak <= 1
    assert margins.phase_margin[which, 0] * tolerance >= 2 * np.arcsin(min(1, 1 / (2 * peak)))


@pytest.mark.parametrize("which", [VELOCITY, POSITION, FORCE])
@given(plants, gains, paths)
def test_delay_and_phase_margin_agree_where_there_is_one_crossover(which, plant, gain, path):
    margins = margins_of(plant, gain, path)
    phase, crossover = margins.phase_margin[which, 0], margins.phase_frequency[which, 0]
    delay, at = margins.delay_margin[which, 0], margins.delay_frequency[which, 0]
    assume(np.isfinite(delay))
    assert delay * at >= phase * (1 - 1e-9)
    assert delay <= (2 * np.pi) / at * (1 + 1e-9)
    assert np.isfinite(crossover)
